"""What the module does without Slicer: frames, surfaces, plans and motion."""

import re

import numpy as np
import pytest
import vtk
from vtk.util import numpy_support

import lipofill
from conftest import SOURCE, face_landmarks
from LipofillLib import figures, motion, plans, surfaces
from LipofillLib.motion import LIFT, PRESSURE, Motion, Still


def ball_image():
    """0 within 6 voxels of (10, 12, 14), -1000 around it."""
    z, y, x = np.indices((28, 24, 20))
    distance = np.sqrt((x - 10.0) ** 2 + (y - 12.0) ** 2 + (z - 14.0) ** 2)
    values = np.clip(-500 + 250 * (6 - distance), -1000, 0).astype(np.int16)
    image = vtk.vtkImageData()
    image.SetDimensions(20, 24, 28)
    image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(values.ravel(), deep=True))
    return image


def matrix(*rows):
    made = vtk.vtkMatrix4x4()
    made.DeepCopy([value for row in rows for value in row])
    return made


def volume_of(surface):
    """Enclosed volume; negative where the triangles look inwards."""
    points, cells = surfaces.arrays_of(surface)
    a, b, c = (points[cells[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def test_a_scan_is_written_in_lps_with_every_digit(tmp_path, face):
    surfaces.write_scan(face, tmp_path / "face.ply")
    reader = vtk.vtkPLYReader()
    reader.SetFileName(str(tmp_path / "face.ply"))
    reader.Update()
    points, cells = surfaces.arrays_of(face)
    read, read_cells = surfaces.arrays_of(reader.GetOutput())
    assert np.array_equal(read, surfaces.turn(points).astype(np.float32)) and np.array_equal(read_cells, cells)
    assert read[0] == pytest.approx((-21.53, -65.291, -18.307), abs=1e-4)


def test_a_surface_goes_there_and_back(face):
    points, cells = surfaces.arrays_of(face)
    again = surfaces.make_surface(surfaces.turn(points), cells)
    assert np.array_equal(surfaces.arrays_of(again)[0], points)
    assert np.array_equal(surfaces.arrays_of(again)[1], cells)


def test_a_surface_without_triangles_is_refused(tmp_path):
    with pytest.raises(ValueError, match="no triangle"):
        surfaces.write_scan(vtk.vtkPolyData(), tmp_path / "none.ply")


@pytest.mark.parametrize("x_of_i", [2.0, -2.0])
def test_the_skin_of_a_volume_is_where_the_volume_is(x_of_i):
    # Voxels of 2 x 1 x 1 mm; Slicer's first column mostly runs to the left, which mirrors.
    to_ras = matrix((x_of_i, 0, 0, 5), (0, 1, 0, -7), (0, 0, 1, 30), (0, 0, 0, 1))
    skin = surfaces.skin_of_volume(ball_image(), to_ras, -500.0)
    middle = 5 + 10 * x_of_i
    assert skin.GetBounds() == pytest.approx((middle - 12, middle + 12, -1, 11, 38, 50), abs=0.1)
    ball = 4 / 3 * np.pi * 6**3 * 2
    assert abs(volume_of(skin)) == pytest.approx(ball, rel=0.03)


def test_both_handednesses_look_the_same_way():
    there = surfaces.skin_of_volume(ball_image(), matrix((2, 0, 0, 5), (0, 1, 0, -7), (0, 0, 1, 3), (0, 0, 0, 1)), -500)
    back = surfaces.skin_of_volume(ball_image(), matrix((-2, 0, 0, 5), (0, 1, 0, -7), (0, 0, 1, 3), (0, 0, 0, 1)), -500)
    assert volume_of(there) * volume_of(back) > 0


def test_a_value_that_a_volume_does_not_take_is_refused_with_its_range():
    with pytest.raises(ValueError, match="its values go from -1000 to 0"):
        surfaces.skin_of_volume(ball_image(), vtk.vtkMatrix4x4(), 700.0)


def test_a_large_surface_is_thinned(face):
    triangles = surfaces.make_surface(*surfaces.arrays_of(face))
    thin = surfaces.thinned(triangles, 5000)
    assert 4000 < thin.GetNumberOfCells() <= 5200
    assert surfaces.thinned(triangles, 10**7) is triangles


def test_the_regions_are_those_of_the_daemon():
    text = (SOURCE / "core" / "anatomy" / "regions.cc").read_text()
    assert set(re.findall(r'^ {6}\{"(\w+)",', text, re.MULTILINE)) == set(plans.REGIONS)


def test_landmarks_get_the_names_of_the_daemon():
    named, unknown = plans.name_landmarks([("go_l", (1.0, 2.0, 3.0)), ("prn", (4.0, 5.0, 6.0)), ("tumour", (0, 0, 0))])
    assert named == {"gonion_left": (1.0, 2.0, 3.0), "pronasale": (4.0, 5.0, 6.0)} and unknown == ["tumour"]
    with pytest.raises(lipofill.InvalidArgumentError, match="gonion_left is there twice, as 'go_l' and 'gonion left'"):
        plans.name_landmarks([("go_l", (1, 2, 3)), ("gonion left", (1, 2, 4))])


def test_the_axes_follow_from_a_pair_and_are_else_those_of_lps():
    choices = plans.Choices([plans.Zone("malar_left", 1.2)])
    paired = plans.make_plan("face.ply", {name: (0.0, 0.0, 0.0) for name, _ in face_landmarks()}, choices)
    assert not paired.model.scan_region.HasField("axes")
    alone = plans.make_plan("face.ply", {"gonion_left": (1.0, 2.0, 3.0)}, choices)
    axes = alone.model.scan_region.axes
    assert (axes.left.x, axes.up.z, axes.forward.y) == (1, 1, -1)
    assert alone.model.scan_region.landmarks_mm["gonion_left"].y == 2.0
    assert alone.simulation.films[0].below_layer == "subcutaneous"
    assert alone.simulation.injections[0].volume_ml == 1.2


@pytest.mark.parametrize(
    "zones, message",
    [
        ([], "no zone"),
        ([plans.Zone("malar_left", 0.0)], "malar_left is 0 mL, must be above 0"),
        ([plans.Zone("chin_left", 1.0), plans.Zone("chin_left", 2.0)], "chin_left is there twice"),
    ],
)
def test_a_plan_that_cannot_be_is_refused(zones, message):
    with pytest.raises(lipofill.InvalidArgumentError, match=message):
        plans.make_plan("face.ply", {}, plans.Choices(zones))


def still(time_s, most):
    return Still(time_s, np.full((5, 3), most, dtype=np.float32), np.full(5, 100 * most, dtype=np.float32))


def test_motion_keeps_so_many_stills_and_the_newest():
    moving = Motion(np.zeros((5, 3)), np.array([[0, 1, 2]], dtype=np.uint32))
    for k in range(3 * motion.MOST_FRAMES):
        moving.add(still(k / 10, k))
        assert len(moving) <= motion.MOST_FRAMES
    times = [each.time_s for each in moving.stills]
    assert times == sorted(times) and times[0] == 0 and times[-1] == (3 * motion.MOST_FRAMES - 1) / 10
    assert moving.most(PRESSURE) == 100 * (3 * motion.MOST_FRAMES - 1)
    assert moving.most(LIFT) == pytest.approx(np.sqrt(3) * (3 * motion.MOST_FRAMES - 1), rel=1e-6)
    assert np.array_equal(moving.points_at(-1), np.full((5, 3), 3.0 * motion.MOST_FRAMES - 1))


def test_figures_have_units():
    from lipofill.v1 import simulation_pb2

    result = simulation_pb2.Simulation(state=simulation_pb2.Simulation.SETTLED)
    result.summary.zones.add(name="malar_left", volume_ml=1.2, mean_pressure_pa=812.4)
    result.summary.remarks.append("the tissue is distorted")
    rows = figures.rows_of(result)
    assert ("malar_left: mean pressure", "812", "Pa") in rows and rows[-1] == ("remark", "the tissue is distorted", "")
    assert rows[0] == ("state", "SETTLED", "")
