#!/usr/bin/env python3
"""A simulation's result as VTK data: measured, and written for ParaView or 3D Slicer.

The arrays of a frame become VTK arrays without a copy of their values. Prints the area and the
largest displacement of the skin.

    open_in_vtk.py simulations/abc --out skin.vtp [--mesh skin] [--server HOST:PORT]
"""

import argparse

import numpy as np
import vtk
from vtk.util import numpy_support

import lipofill


def cells_of(connectivity):
    """Triangles or quadrilaterals, (n, 3) or (n, 4), as a vtkCellArray."""
    cells = vtk.vtkCellArray()
    offsets = np.arange(0, connectivity.size + 1, connectivity.shape[1], dtype=np.int64)
    cells.SetData(
        numpy_support.numpy_to_vtk(offsets, deep=True),
        numpy_support.numpy_to_vtk(connectivity.ravel().astype(np.int64), deep=True),
    )
    return cells


def surface_of(frame, mesh):
    """The surface `mesh` as it is in the frame, with all of its fields; `frame` must live as long
    as it.
    """
    points = vtk.vtkPoints()
    points.SetData(numpy_support.numpy_to_vtk(frame.moved_points(mesh), deep=True))
    surface = vtk.vtkPolyData()
    surface.SetPoints(points)
    surface.SetPolys(cells_of(frame.meshes[f"{mesh}.cells"]))
    for array in frame.fields.values():
        if array.mesh != mesh:
            continue
        values = numpy_support.numpy_to_vtk(array.values, deep=False)
        unit = array.unit.replace("/", "_per_").lower()
        values.SetName(f"{array.field}_{unit}" if unit else array.field)
        (surface.GetPointData() if array.location == "point" else surface.GetCellData()).AddArray(values)
    return surface


def area_cm2(surface):
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputData(surface)
    properties = vtk.vtkMassProperties()
    properties.SetInputConnection(triangles.GetOutputPort())
    return properties.GetSurfaceArea() / 100


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("simulation")
    parser.add_argument("--out", required=True, help="a .vtp file")
    parser.add_argument("--mesh", default="skin", help="skin, scan or film/<film>")
    parser.add_argument("--server", help="default: LIPOFILL_SERVER, else 127.0.0.1:50061")
    arguments = parser.parse_args()
    with lipofill.Connection(arguments.server) as connection:
        frame = connection.simulations[arguments.simulation].final_frame(meshes=[arguments.mesh])
    surface = surface_of(frame, arguments.mesh)
    lift = np.linalg.norm(frame[f"{arguments.mesh}.displacement"], axis=1).max()
    print(f"{surface.GetNumberOfPoints()} points, {area_cm2(surface):.1f} cm2, moved by up to {lift:.2f} mm")
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(arguments.out)
    writer.SetInputData(surface)
    if writer.Write() != 1:
        raise SystemExit(f"cannot write {arguments.out}")


if __name__ == "__main__":
    main()
