"""Surfaces between Slicer and the daemon: RAS there, LPS here, millimetres in both."""

from __future__ import annotations

import os
from typing import Any, Iterable, Tuple

import numpy as np
import numpy.typing as npt
import vtk
from vtk.util import numpy_support

Points = npt.NDArray[np.float64]
#: More triangles than the daemon's default resolution sees.
MOST_TRIANGLES_OF_A_VOLUME = 250_000


def turn(points: npt.ArrayLike) -> Points:
    """Points of RAS in LPS, and back: x and y change their signs. (n, 3), mm."""
    return np.asarray(points, dtype=np.float64) * (-1.0, -1.0, 1.0)


def moved_by(surface: vtk.vtkPolyData, transform: vtk.vtkAbstractTransform) -> vtk.vtkPolyData:
    """A surface under a transform."""
    mover = vtk.vtkTransformPolyDataFilter()
    mover.SetInputData(surface)
    mover.SetTransform(transform)
    mover.Update()
    return mover.GetOutput()


def skin_of_volume(image: vtk.vtkImageData, ijk_to_ras: vtk.vtkMatrix4x4, isovalue: float) -> vtk.vtkPolyData:
    """The largest connected surface where a volume takes a value, in RAS; a CT has its skin at
    -300 HU.

    Raises
    ------
    ValueError
        The volume does not take the value; the message has the range that it takes.
    """
    least, most = image.GetScalarRange()
    if not least < isovalue < most:
        raise ValueError(f"the value {isovalue:g} is not in the volume; its values go from {least:g} to {most:g}")
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.SetValue(0, isovalue)
    contour.ComputeNormalsOff()
    largest = vtk.vtkPolyDataConnectivityFilter()
    largest.SetInputConnection(contour.GetOutputPort())
    largest.SetExtractionModeToLargestRegion()
    clean = vtk.vtkCleanPolyData()
    clean.SetInputConnection(largest.GetOutputPort())
    clean.Update()
    place = vtk.vtkTransform()
    place.SetMatrix(ijk_to_ras)
    skin = moved_by(clean.GetOutput(), place)
    if ijk_to_ras.Determinant() < 0:
        # A frame that mirrors turns the triangles inside out.
        turner = vtk.vtkReverseSense()
        turner.SetInputData(skin)
        turner.Update()
        skin = turner.GetOutput()
    return thinned(skin, MOST_TRIANGLES_OF_A_VOLUME)


def thinned(surface: vtk.vtkPolyData, most: int) -> vtk.vtkPolyData:
    """A surface of at most about as many triangles."""
    if surface.GetNumberOfCells() <= most:
        return surface
    decimation = vtk.vtkQuadricDecimation()
    decimation.SetInputData(surface)
    decimation.SetTargetReduction(1.0 - most / surface.GetNumberOfCells())
    decimation.Update()
    return decimation.GetOutput()


def arrays_of(surface: vtk.vtkPolyData) -> Tuple[Points, npt.NDArray[np.int32]]:
    """Points (n, 3) and triangles (m, 3) of a surface; polygons and strips become triangles.

    Raises ValueError for a surface without a triangle.
    """
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputData(surface)
    triangles.PassLinesOff()
    triangles.PassVertsOff()
    triangles.Update()
    made = triangles.GetOutput()
    if made.GetNumberOfPolys() == 0:
        raise ValueError("the surface has no triangle")
    cells = numpy_support.vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return numpy_support.vtk_to_numpy(made.GetPoints().GetData()).astype(np.float64), cells.astype(np.int32)


def write_scan(surface: vtk.vtkPolyData, file: "str | os.PathLike[str]") -> None:
    """Writes a surface of RAS as a PLY file in LPS, with the precision of a double."""
    points, triangles = arrays_of(surface)
    head = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    with open(file, "wb") as stream:
        stream.write(head.encode("ascii") + turn(points).astype("<f8").tobytes() + faces.tobytes())


def make_surface(points_lps: npt.ArrayLike, cells: npt.NDArray[Any]) -> vtk.vtkPolyData:
    """A surface of the daemon, (n, 3) points in LPS and (m, 3 or 4) corners, in RAS."""
    surface = vtk.vtkPolyData()
    surface.SetPoints(vtk.vtkPoints())
    place(surface, points_lps)
    polygons = vtk.vtkCellArray()
    offsets = np.arange(0, cells.size + 1, cells.shape[1], dtype=np.int64)
    polygons.SetData(
        numpy_support.numpy_to_vtk(offsets, deep=True),
        numpy_support.numpy_to_vtk(cells.ravel().astype(np.int64), deep=True),
    )
    surface.SetPolys(polygons)
    return surface


def place(surface: vtk.vtkPolyData, points_lps: npt.ArrayLike) -> None:
    """Puts the points of a surface of RAS where the daemon has them."""
    surface.GetPoints().SetData(numpy_support.numpy_to_vtk(turn(points_lps), deep=True))
    surface.GetPoints().Modified()
    surface.Modified()


def set_scalars(surface: vtk.vtkPolyData, named: Iterable[Tuple[str, npt.NDArray[Any]]]) -> None:
    """Arrays on the points of a surface, each under its name, in place of earlier ones of it."""
    for name, values in named:
        array = numpy_support.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        surface.GetPointData().AddArray(array)
    surface.Modified()
