"""Settled shapes that are found at once, and fat that is added to a run that has settled."""

import numpy as np
import pytest

import lipofill
from conftest import PLANS
from lipofill.v1 import simulation_pb2


@pytest.fixture(scope="module")
def settled(connection):
    plan = lipofill.Plan.load(PLANS / "jaw_angle.json")
    plan.simulation.ClearField("time")
    plan.simulation.time.goal = simulation_pb2.TimeControl.SETTLED_SHAPE
    with connection.run(plan) as run:
        yield run, run.wait()


def test_it_is_the_shape_of_the_run(connection, settled):
    run, result = settled
    shape = connection.simulations.find_shape(run.name)
    assert shape.figures.from_rest and shape.figures.volume_share == 1.0
    assert shape.figures.summary.state_hash == result.summary.state_hash
    lift = np.linalg.norm(shape["skin.displacement"], axis=1).max()
    assert lift == pytest.approx(result.summary.skin_max_displacement_mm, rel=1e-5)


def test_a_drag_follows_its_volumes(connection, settled):
    run, _ = settled
    lifts = []
    for volume_ml in (2.0, 2.05, 2.1):
        shape = connection.simulations.find_shape(
            run.name, volumes_ml={0: volume_ml}, drag="slider", fields=["skin.displacement"]
        )
        lifts.append(shape.figures.summary.skin_max_displacement_mm)
        assert list(shape.fields) == ["skin.displacement"]
    assert lifts == sorted(lifts) and not shape.figures.from_rest


def test_sensitivities_have_their_fields(connection, settled):
    run, _ = settled
    shape = connection.simulations.find_shape(run.name, with_sensitivities=True)
    for place, by in enumerate(shape.figures.sensitivities):
        largest = np.linalg.norm(shape[f"skin.sensitivity/{place}"], axis=1).max()
        assert largest == pytest.approx(by.max_displacement_mm, rel=1e-5)


def test_what_is_wrong_is_named(connection, settled):
    run, _ = settled
    with pytest.raises(lipofill.InvalidArgumentError, match="added.0..zone"):
        connection.simulations.find_shape(run.name, added_ml={"nose": 0.1})
    stepped = simulation_pb2.SimulationSpec()
    stepped.CopyFrom(run.get().spec)
    stepped.fat.yield_stress_pa = 20.0
    with pytest.raises(lipofill.FailedPreconditionError, match="fat.yield_stress_pa"):
        connection.simulations.find_shape(stepped)


def test_a_settled_run_goes_on_with_more_fat(connection, settled):
    run, result = settled
    zone = result.summary.zones[0].name
    foreseen = connection.simulations.find_shape(run.name, added_ml={zone: 0.3})
    run.inject(zone, volume_ml=0.3, rate_ml_per_s=1.0)
    more = run.wait()
    assert more.summary.film_volume_ml == pytest.approx(result.summary.film_volume_ml + 0.3, abs=1e-9)
    assert more.summary.skin_max_displacement_mm == pytest.approx(
        foreseen.figures.summary.skin_max_displacement_mm, abs=0.003
    )
    assert len(more.spec.injections) == len(result.spec.injections) + 1
