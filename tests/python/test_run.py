"""A whole plan, from scan to result."""

import numpy as np
import pytest

import lipofill
from conftest import PLANS, make_plate
from lipofill.v1 import simulation_pb2


@pytest.fixture(scope="module")
def jaw(connection):
    plan = lipofill.Plan.load(PLANS / "jaw_angle.json").settle()
    told = []
    with connection.run(plan, progress=told.append) as run:
        with run.watch(meshes=["skin", "scan", "film/deep"], max_rate_hz=0) as frames:
            seen = list(frames)
        result = run.wait(progress=told.append)
        yield run, result, seen, told
    left = [patient.name for patient in connection.patients.list()]
    assert run.patient not in left


def test_the_settled_shape_is_that_of_the_plan(jaw):
    run, result, _, _ = jaw
    assert result.State.Name(result.state) == "SETTLED"
    assert result.summary.injected_ml == pytest.approx(4.5, abs=1e-9)
    assert result.summary.film_volume_relative_error < 1e-9
    assert 3 < result.summary.skin_max_displacement_mm < 6
    assert run.model.report.hexahedra == 2 * 40 * 31


def test_progress_names_every_stage_and_ends_whole(jaw):
    told = jaw[3]
    assert list(dict.fromkeys(each.stage for each in told)) == ["upload", "build", "simulate"]
    assert all(0 <= each.fraction <= 1 for each in told)
    for stage in ("upload", "build", "simulate"):
        assert [each.fraction for each in told if each.stage == stage][-1] == 1.0


def test_frames_show_what_the_summary_says(jaw):
    _, result, seen, _ = jaw
    last = seen[-1]
    assert last.end and last.sequence == result.summary.steps
    lift = np.linalg.norm(last["skin.displacement"], axis=1).max()
    assert lift == pytest.approx(result.summary.skin_max_displacement_mm, rel=1e-5)
    assert last["film/deep.pressure"].max() == pytest.approx(result.summary.max_pressure_pa, rel=1e-5)
    assert last.fields["skin.displacement"].unit == "mm" and last.fields["film/deep.pressure"].location == "cell"
    assert set(last.meshes.names()) == {"skin", "scan", "film/deep"}
    moved = last.moved_points("scan")
    assert moved.shape == last.meshes["scan.points"].shape
    assert last.meshes["scan.cells"].max() < len(moved)


def test_the_series_is_the_same_run(jaw):
    run, result, _, _ = jaw
    series = run.series()
    assert len(series) == result.summary.steps
    assert series["time_s"][-1] == result.summary.time_s
    assert series["injected_ml"][-1] == result.summary.injected_ml
    assert series["probe_thickness_mm"].shape == (len(series), 2)
    assert (np.diff(series["step"].astype(int)) == 1).all()
    with pytest.raises(KeyError):
        series["pressure"]


def test_the_final_frame_is_the_last_that_was_watched(jaw):
    run, _, seen, _ = jaw
    final = run.final_frame(meshes=["skin"])
    assert np.array_equal(final["skin.displacement"], seen[-1]["skin.displacement"])


def test_the_meshes_of_a_model_can_be_fetched(jaw, connection):
    meshes = connection.models.download_meshes(jaw[0].model.name)
    assert {"skin", "tissue", "scan"} <= set(meshes.names())
    assert meshes["tissue.cells"].shape == (2 * 40 * 31, 8)


def test_the_surface_of_a_scan_can_be_fetched(jaw, connection):
    (scan,) = connection.scans.list(jaw[0].patient)
    meshes = connection.scans.download_mesh(scan.name)
    assert (
        meshes["scan.points"].shape == (scan.report.vertices, 3) and len(meshes["scan.cells"]) == scan.report.triangles
    )


def test_the_tissue_can_be_exported(jaw):
    assert b"*NODE" in jaw[0].tissue_deck().upper()


def test_the_distance_of_a_result_to_its_own_scan_is_what_was_injected(jaw, connection):
    run, result, _, _ = jaw
    scan = next(connection.scans.list(run.patient))
    evaluation = run.evaluate(scan.name)
    assert evaluation.before_to_target.max_mm < 1e-3
    assert 0 < evaluation.simulated_to_target.max_mm <= result.summary.skin_max_displacement_mm + 1e-3


def test_a_painted_zone_is_where_it_was_painted(connection):
    painted = np.zeros((21, 21))
    painted[4:17, 4:10] = 1.0
    plan = make_plate()
    plan.simulation.ClearField("films")
    plan.simulation.injections[0].ClearField("site")
    plan.film("deep", below="skin", n_xi=6, n_eta=6, zones={"middle": lipofill.samples(painted)})
    run = connection.run(plan)
    with run.watch(meshes=["skin"]) as frames, run:
        *_, last = frames
    lift = last["skin.displacement"][:, 2]
    middle = last.meshes["skin.points"][:, 0].mean()
    left = last.meshes["skin.points"][:, 0] < middle
    assert lift[left].max() > 3 * lift[~left].max()


def test_a_patient_is_changed_by_one_at_a_time(connection):
    patient = connection.patients.create(display_name="first", labels={"side": "left"})
    patient.display_name = "second"
    changed = connection.patients.update(patient, "display_name")
    assert changed.display_name == "second" and changed.labels == {"side": "left"}
    with pytest.raises(lipofill.AbortedError):
        connection.patients.update(patient, "display_name")
    connection.patients.delete(patient.name)


def test_what_is_only_checked_is_not_kept(connection, plate):
    patient = connection.patients.create().name
    connection.models.check(patient, plate.model)
    assert not list(connection.models.list(patient))
    plate.model.layers[0].ClearField("youngs_modulus_kpa")
    with pytest.raises(lipofill.InvalidArgumentError):
        connection.models.check(patient, plate.model)
    connection.patients.delete(patient)
    with connection.run(make_plate()) as run:
        before = [each.name for each in connection.simulations.list()]
        assert connection.simulations.check(run.get().spec).summary.film_cells > 0
        found = connection.simulations.check_plan(run.get().spec)
        assert not found.violations and found.zones[0].area_cm2 > 0 and found.zones[0].outline
        spoilt = run.get().spec
        spoilt.fat.density_kg_m3 = -1
        assert [each.field for each in connection.simulations.check_plan(spoilt).violations] == [
            "spec.fat.density_kg_m3"
        ]
        assert [each.name for each in connection.simulations.list()] == before


def test_leaving_a_run_stops_it_and_takes_away_what_it_made(connection):
    with connection.run(make_plate(end_s=1000)) as run:
        run.pause()
        assert run.get().State.Name(run.get().state) == "PAUSED"
        run.resume()
    with pytest.raises(lipofill.NotFoundError):
        run.get()
    with pytest.raises(lipofill.NotFoundError):
        connection.models.get(run.model.name)
    with pytest.raises(lipofill.NotFoundError):
        connection.patients.get(run.patient)


def test_a_run_that_is_kept_is_there_after(connection):
    with connection.run(make_plate(), keep=True) as run:
        run.wait()
    assert run.get().summary.steps == 30
    assert any(each.name == run.name for each in connection.simulations.list())
    run.discard()


def test_the_same_plan_gives_the_same_state(connection, plate):
    hashes = set()
    for _ in range(2):
        with connection.run(plate) as run:
            hashes.add(run.wait().summary.state_hash)
    assert len(hashes) == 1


def test_an_injection_and_a_checkpoint_while_it_runs(connection):
    plan = make_plate(end_s=1.0)
    plan.simulation.pace = simulation_pb2.REAL_TIME
    with connection.run(plan) as run:
        run.pause()
        kept = run.checkpoint("before")
        run.inject("middle", volume_ml=0.1, rate_ml_per_s=1.0)
        run.resume()
        assert run.wait().summary.injected_ml == pytest.approx(0.4)
        assert kept.name in [each.name for each in run.checkpoints()]
        branch = run.branch(kept.name, start=True)
        assert branch.wait().summary.injected_ml == pytest.approx(0.3)
        branch.delete()


def test_waiting_has_an_end(connection):
    with connection.run(make_plate(end_s=1000)) as run:
        with pytest.raises(lipofill.DeadlineExceededError):
            run.wait(timeout_s=0.1)


def test_what_was_made_is_taken_away_where_the_plan_is_refused(connection, plate):
    before = list(connection.patients.list())
    plate.model.layers[0].poisson_ratio = 0.7
    with pytest.raises(lipofill.InvalidArgumentError):
        connection.run(plate)
    assert list(connection.patients.list()) == before
