"""The examples, run as their users run them."""

import csv
import os
import subprocess
import sys

import pytest

import lipofill
from conftest import PLANS, SOURCE, make_plate

EXAMPLES = SOURCE / "client" / "python" / "examples"


def run_example(name, *arguments, **environment):
    command = [sys.executable, *(["-m", "pytest", "-q", "-p", "no:cacheprovider"] if name.startswith("test_") else [])]
    return subprocess.run(
        [*command, str(EXAMPLES / name), *map(str, arguments)],
        env={**os.environ, "MPLCONFIGDIR": os.environ.get("TMPDIR", "/tmp"), **environment},
        capture_output=True,
        text=True,
        timeout=200,
    )


def test_a_stiffer_skin_rises_less_under_more_pressure(tmp_path, daemon):
    done = run_example(
        "sweep_stiffness.py",
        PLANS / "jaw_angle.json",
        "--out",
        tmp_path,
        "--moduli-kpa",
        90,
        200,
        500,
        "--server",
        daemon.server,
    )
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader(open(tmp_path / "sweep.csv")))
    lifts = [float(row["skin_max_displacement_mm"]) for row in rows]
    pressures = [float(row["max_pressure_pa"]) for row in rows]
    assert len(rows) == 3 and lifts == sorted(lifts, reverse=True) and pressures == sorted(pressures)
    assert all(row["state"] == "SETTLED" for row in rows)
    pixels = pytest.importorskip("matplotlib.image").imread(tmp_path / "sweep.png")
    assert pixels.shape[1] > 1000 and (pixels[..., :3].min(axis=-1) < 0.5).mean() > 0.01


def test_a_result_opens_in_vtk(tmp_path, daemon, connection):
    vtk = pytest.importorskip("vtk")
    with connection.run(make_plate()) as run:
        lift = run.wait().summary.skin_max_displacement_mm
        done = run_example("open_in_vtk.py", run.name, "--out", tmp_path / "skin.vtp", LIPOFILL_SERVER=daemon.server)
    assert done.returncode == 0, done.stderr
    assert f"moved by up to {lift:.2f} mm" in done.stdout and "169 points" in done.stdout
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(tmp_path / "skin.vtp"))
    reader.Update()
    moved = reader.GetOutput().GetPointData().GetArray("displacement_mm")
    assert moved.GetMaxNorm() == pytest.approx(lift, rel=1e-5)


@pytest.mark.parametrize("with_server", [False, True])
def test_a_plan_holds_in_ci(daemon, with_server):
    done = run_example("test_plan_in_ci.py", **({"LIPOFILL_SERVER": daemon.server} if with_server else {}))
    assert done.returncode == 0 and "5 passed" in done.stdout, done.stdout


def test_a_plan_that_does_not_hold_fails_the_build(tmp_path, daemon):
    plan = lipofill.Plan.load(PLANS / "jaw_angle.json")
    for injection in plan.simulation.injections:
        injection.volume_ml = 0.1
    plan.save(tmp_path / "little.json")
    done = run_example("test_plan_in_ci.py", PLAN=str(tmp_path / "little.json"), LIPOFILL_SERVER=daemon.server)
    assert done.returncode == 1 and "test_the_skin_rises_as_it_should" in done.stdout, done.stdout
    assert "1 failed, 4 passed" in done.stdout
