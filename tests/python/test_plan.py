"""Plans: read, built in code, written, and the same to the command line."""

import json
import os
import subprocess

import pytest

import lipofill
from conftest import PLANS, make_plate


@pytest.mark.parametrize("path", sorted(PLANS.glob("*.json")), ids=lambda path: path.stem)
def test_what_is_read_and_written_is_the_same_plan(path, tmp_path):
    if ".landmarks" in path.name:
        pytest.skip("not a plan")
    plan = lipofill.Plan.load(path)
    plan.save(tmp_path / "again.json")
    again = lipofill.Plan.load(tmp_path / "again.json")
    for field in ("file", "landmarks_file"):
        named = getattr(plan.message.scan, field).partition("#")[0]
        kept = getattr(again.message.scan, field).partition("#")[0]
        assert not named or (plan.folder / named).resolve() == (again.folder / kept).resolve()
    again.message.scan.CopyFrom(plan.message.scan)
    if not plan.message.HasField("scan"):
        again.message.ClearField("scan")
    assert again.message == plan.message


def test_an_unknown_field_is_named_with_its_path_and_the_nearest_name():
    with pytest.raises(lipofill.InvalidArgumentError) as caught:
        lipofill.Plan.from_json('{"model": {"layers": [{"youngs_moduls_kpa": 3}]}}')
    (violation,) = caught.value.violations
    assert violation.field == "model.layers[0].youngs_moduls_kpa"
    assert "youngsModulusKpa" in violation.description or "youngs_modulus_kpa" in violation.description


def test_a_name_that_there_is_not_is_answered_with_those_there_are():
    with pytest.raises(lipofill.InvalidArgumentError) as caught:
        lipofill.Plan.from_json('{"simulation": {"fat": {"preset": "COLEMANN"}}}')
    (violation,) = caught.value.violations
    assert violation.field == "simulation.fat.preset"
    assert violation.description == 'is "COLEMANN", must be one of NEWTONIAN, COLEMAN, NANOFAT, SVF_GEL'


def test_what_is_not_json_is_refused(tmp_path):
    (tmp_path / "plan.json").write_text("{")
    with pytest.raises(lipofill.InvalidArgumentError, match="plan.json"):
        lipofill.Plan.load(tmp_path / "plan.json")


def test_the_command_line_runs_a_plan_built_in_code_to_the_same_state(tmp_path, daemon, connection):
    plan = make_plate()
    plan.save(tmp_path / "plate.json")
    command = [os.environ["LIPOFILL"], "run", str(tmp_path / "plate.json"), "--out", str(tmp_path / "out")]
    subprocess.run([*command, "--server", daemon.server, "--no-picture", "--quiet", "--discard"], check=True)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    with connection.run(plan) as run:
        assert run.wait().summary.state_hash == summary["state_hash"]


def test_a_landmarks_file_of_a_square_is_refused(tmp_path, plate):
    plate.message.scan.landmarks_file = "marks.json"
    with pytest.raises(lipofill.InvalidArgumentError) as caught:
        plate.model_with_landmarks()
    assert caught.value.violations[0].field == "scan.landmarks_file"


@pytest.mark.parametrize(
    "content, complaint",
    [
        ('{"landmarks": {"a": [1, 2]}}', r"landmarks\.a is not \[x, y, z\]"),
        ('{"landmarks": {"a": [1, 2, "x"]}}', r"landmarks\.a\[2\] is not a finite number"),
        ('{"landmarks": {"a": [1, 2, NaN]}}', r"landmarks\.a\[2\] is not a finite number"),
        ('{"units": "inch", "landmarks": {}}', "units is 'inch'"),
        ("[]", "not a JSON object"),
        ('{"points": {}}', 'no object "landmarks"'),
    ],
)
def test_a_landmarks_file_that_is_wrong_is_named(tmp_path, content, complaint):
    (tmp_path / "marks.json").write_text(content)
    plan = lipofill.Plan(folder=tmp_path).face("face.obj", corners=[], n_xi=2, n_eta=2, landmarks="marks.json")
    with pytest.raises(lipofill.InvalidArgumentError, match=complaint) as caught:
        plan.model_with_landmarks()
    assert "marks.json" in str(caught.value)


def test_landmarks_are_in_millimetres_whatever_their_file_says(tmp_path):
    axes = {"left": [1, 0, 0], "up": [0, 1, 0], "forward": [0, 0, 1]}
    (tmp_path / "marks.json").write_text(json.dumps({"units": "cm", "before": {"tip": [1, 2, 3]}, "axes": axes}))
    plan = lipofill.Plan(folder=tmp_path).face("face.obj", corners=[], n_xi=2, n_eta=2, landmarks="marks.json#before")
    region = plan.model_with_landmarks().scan_region
    assert (region.landmarks_mm["tip"].x, region.landmarks_mm["tip"].z) == (10, 30)
    assert region.axes.forward.z == 1
