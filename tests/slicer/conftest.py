"""The module for 3D Slicer with stubs of Slicer's API, real VTK and the real daemon."""

import json
import os
import pathlib
import sys

import pytest
import vtk

import lipofill
import stubs

SOURCE = pathlib.Path(os.environ["LIPOFILL_SOURCE"])
FACES = SOURCE / "client" / "examples" / "faces"
sys.path.insert(0, str(SOURCE / "client" / "slicer" / "Lipofill"))


@pytest.fixture(scope="module")
def daemon():
    with lipofill.Daemon(arguments=["--workers", "2"]) as running:
        yield running


def to_ras(point):
    """A point of the synthetic face (x left, y up, z forward) in RAS."""
    x, y, z = point
    return (-x, z, y)


def face_landmarks():
    """Labels and places of the synthetic face, in RAS."""
    document = json.loads((FACES / "half_face.landmarks.json").read_text())
    return [(name, to_ras(point)) for name, point in document["landmarks"].items()]


@pytest.fixture(scope="session")
def face():
    """The synthetic face as Slicer has it: a surface in RAS."""
    reader = vtk.vtkOBJReader()
    reader.SetFileName(str(FACES / "half_face.obj"))
    turn = vtk.vtkTransform()
    turn.SetMatrix((-1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1))
    mover = vtk.vtkTransformPolyDataFilter()
    mover.SetInputConnection(reader.GetOutputPort())
    mover.SetTransform(turn)
    mover.Update()
    return mover.GetOutput()


@pytest.fixture(scope="session")
def slicer():
    return stubs.install()
