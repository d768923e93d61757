"""The panel, loaded with stubs of Slicer's API, against the real daemon."""

import sys
import time

import numpy as np
import pytest
import vtk
from vtk.util import numpy_support

import stubs
from conftest import face_landmarks
from test_library import ball_image, matrix

WAIT_S = 200.0


@pytest.fixture
def module(slicer):
    import Lipofill

    slicer.mrmlScene.nodes.clear()
    return Lipofill


@pytest.fixture
def panel(module, slicer, daemon):
    made = module.LipofillWidget()
    made.setup()
    made.server.text = daemon.server
    made.resolution.choose("coarse, quickest")
    yield made
    made.cleanup()


def choose_face(panel, slicer, face, landmarks):
    model = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode", "face")
    model.SetAndObservePolyData(face)
    panel.faceSelector.choose(model)
    panel.landmarkSelector.choose(stubs.MarkupsNode("F", landmarks))
    return model


def add_zone(panel, region, side, volume_ml):
    panel.region.choose(region)
    panel.side.choose(side)
    panel.volume.setValue(volume_ml)
    panel.onAddZone()


def let_it_run(panel, until=lambda: False):
    """What Slicer's event loop does, until the run has ended or `until` holds."""
    deadline = time.monotonic() + WAIT_S
    while panel.timer.running and not until():
        assert time.monotonic() < deadline, "the run has not come to its end"
        panel.timer.emit("timeout()")
        time.sleep(0.02)


def patients_of(daemon):
    with daemon.connect() as connection:
        return [patient.name for patient in connection.patients.list()]


def test_a_run_moves_the_skin_and_colours_it(panel, slicer, face, daemon):
    choose_face(panel, slicer, face, face_landmarks() + [("my note", (0.0, 0.0, 0.0))])
    assert not panel.runButton.enabled
    add_zone(panel, "malar", "left", 0.4)
    add_zone(panel, "malar", "left", 1.2)
    assert panel.zoneLabel.text == "malar_left: 1.2 mL" and panel.runButton.enabled
    panel.settledOnly.checked = True
    panel.runButton.click()
    assert panel.runButton.text == "Cancel" and panel.landmarkNote.text == "Not known, and left out: my note"
    let_it_run(panel)
    assert panel.status.text.startswith("settled") and "not a medical device" in panel.status.text

    node, moving = panel.logic.resultNode, panel.logic.motion
    surface = node.GetPolyData()
    points = numpy_support.vtk_to_numpy(surface.GetPoints().GetData())
    data = surface.GetPointData()
    lift, pressure = (numpy_support.vtk_to_numpy(data.GetArray(name)) for name in ("lift_mm", "pressure_pa"))
    displacement = numpy_support.vtk_to_numpy(data.GetArray("displacement_mm"))
    at = int(lift.argmax())
    # In RAS the left cheek is at negative x, and it is lifted to the left and to the front.
    assert points[at][0] < -20 and displacement[at][0] < 0 and displacement[at][1] > 0
    assert 1 < lift.max() < 12 and pressure.max() > 100
    rest = moving.points_mm * (-1, -1, 1)
    assert points == pytest.approx(rest + displacement, abs=1e-3)
    figures = {panel.figures.cells[k, 0]: panel.figures.cells[k, 1] for k in range(4)}
    assert figures["injected"] == "1.200"
    assert float(figures["largest lift of the skin"]) == pytest.approx(lift.max(), abs=0.3)

    display = node.GetDisplayNode()
    assert (
        display.visible and display.scalar == "lift_mm" and display.range == (0.0, pytest.approx(lift.max(), rel=1e-6))
    )
    assert stubs.ColorLogic.titles[node.GetID()] == "Lift (mm)"
    panel.scalar.choose("Pressure of the fat (Pa)")
    assert display.scalar == "pressure_pa" and stubs.ColorLogic.titles[node.GetID()] == "Pressure of the fat (Pa)"
    assert patients_of(daemon) == []


def test_the_slider_goes_back_to_rest(panel, slicer, face):
    choose_face(panel, slicer, face, face_landmarks())
    add_zone(panel, "malar", "left", 0.3)
    panel.runButton.click()
    let_it_run(panel)
    moving = panel.logic.motion
    # How many pictures come depends on how busy the machine is.
    assert len(moving) > 1 and panel.time.maximum == len(moving) - 1
    panel.time.value = 0
    surface = panel.logic.resultNode.GetPolyData()
    first = numpy_support.vtk_to_numpy(surface.GetPointData().GetArray("lift_mm")).max()
    panel.time.value = len(moving) - 1
    last = numpy_support.vtk_to_numpy(surface.GetPointData().GetArray("lift_mm")).max()
    assert first < 0.05 < 0.3 < last


def test_a_second_run_takes_the_place_of_the_first_also_where_its_node_was_deleted(panel, slicer, face):
    from LipofillLib.motion import Motion

    rest = Motion(np.zeros((3, 3)), np.array([[0, 1, 2]], dtype=np.uint32))
    panel.logic.beginMotion(rest)
    node = panel.logic.resultNode
    panel.logic.beginMotion(rest)
    assert panel.logic.resultNode is node
    slicer.mrmlScene.RemoveNode(node)
    panel.logic.beginMotion(rest)
    assert panel.logic.resultNode is not node and len(slicer.mrmlScene.nodes) == 1


def test_a_run_can_be_cancelled_and_leaves_nothing(panel, slicer, face, daemon):
    choose_face(panel, slicer, face, face_landmarks())
    add_zone(panel, "masseter", "left", 3.0)
    panel.runButton.click()
    let_it_run(panel, until=lambda: panel.status.text.startswith("simulate"))
    panel.runButton.click()
    let_it_run(panel)
    assert "cancelled" in panel.status.text and panel.runButton.text == "Run"
    assert patients_of(daemon) == []


def test_what_the_daemon_refuses_is_shown_with_its_field(panel, slicer, face):
    known = [(name, point) for name, point in face_landmarks() if not name.startswith("zygion")]
    choose_face(panel, slicer, face, known)
    add_zone(panel, "malar", "left", 1.0)
    panel.runButton.click()
    let_it_run(panel)
    assert "zygion_left" in panel.status.text and panel.runButton.enabled


def test_a_daemon_that_is_not_there_is_told(panel, slicer, face, tmp_path):
    panel.server.text = f"unix:{tmp_path}/none"
    choose_face(panel, slicer, face, face_landmarks())
    add_zone(panel, "malar", "left", 1.0)
    panel.runButton.click()
    let_it_run(panel)
    assert panel.status.text.startswith("UNAVAILABLE")


def test_a_face_without_a_surface_is_refused_before_anything_is_sent(panel, slicer):
    choose_face(panel, slicer, vtk.vtkPolyData(), face_landmarks())
    add_zone(panel, "malar", "left", 1.0)
    panel.runButton.click()
    assert panel.status.text == "the model face has no surface" and not panel.timer.running


def test_a_volume_is_where_its_transforms_put_it(module, slicer):
    node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "ct")
    node.SetAndObserveImageData(ball_image())
    node.to_ras = matrix((-1, 0, 0, 0), (0, -1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
    logic = module.LipofillLogic()
    assert logic.surfaceOf(node, -500).GetBounds() == pytest.approx((-16, -4, -18, -6, 8, 20), abs=0.1)
    shift = vtk.vtkTransform()
    shift.Translate(100, 0, -5)
    node.parent = stubs.TransformNode(shift)
    assert logic.surfaceOf(node, -500).GetBounds() == pytest.approx((84, 96, -18, -6, 3, 15), abs=0.1)


def test_points_that_are_not_placed_are_no_landmarks(module, slicer):
    points = [("go_l", (1.0, 2.0, 3.0)), ("prn", (4.0, 5.0, 6.0), stubs.MarkupsNode.PositionUndefined)]
    assert module.LipofillLogic().landmarksOf(stubs.MarkupsNode("F", points)) == [("go_l", (-1.0, -2.0, 3.0))]


def test_slicers_self_test_passes(module):
    result = module.LipofillTest()
    result.setUp()
    result.runTest()


def test_without_the_client_the_panel_says_how_to_install_it(module, slicer, monkeypatch):
    monkeypatch.setitem(sys.modules, "lipofill", None)
    panel = module.LipofillWidget()
    panel.setup()
    panel.packagePath.currentPath = "/somewhere/python"
    panel.onInstall()
    assert slicer.installed == ['"/somewhere/python"'] and panel.logic is None
    panel.cleanup()


def test_the_module_says_what_it_is(module):
    class Parent:
        pass

    parent = Parent()
    module.Lipofill(parent)
    assert "not a medical device" in parent.helpText and parent.title and parent.categories
