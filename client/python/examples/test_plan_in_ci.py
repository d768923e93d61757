"""A plan under continuous integration: what a clinic relies on is asserted, and a change that
breaks it fails the build.

    PLAN=jaw_angle.json python3 -m pytest test_plan_in_ci.py

Runs a private daemon, or the one that LIPOFILL_SERVER names.
"""

import os

import pytest

import lipofill

CRITICAL_PRESSURE_PA = 4000  # 30 mmHg: above, the tissue is at risk
SAMPLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples", "plans", "jaw_angle.json")


@pytest.fixture(scope="module")
def result():
    """The settled shape of the plan."""
    plan = lipofill.Plan.load(os.environ.get("PLAN", SAMPLE)).settle()
    with lipofill.Daemon() if "LIPOFILL_SERVER" not in os.environ else lipofill.Connection() as daemon:
        connection = daemon.connect() if isinstance(daemon, lipofill.Daemon) else daemon
        with connection.run(plan) as run:
            yield run.wait(timeout_s=300)


def test_the_skin_comes_to_rest(result):
    assert result.State.Name(result.state) == "SETTLED", result.reason


def test_all_that_was_planned_is_injected(result):
    planned = sum(injection.volume_ml for injection in result.spec.injections)
    assert result.summary.injected_ml == pytest.approx(planned, abs=1e-9)
    assert result.summary.film_volume_relative_error < 1e-9


def test_the_skin_rises_as_it_should(result):
    assert 1 < result.summary.skin_max_displacement_mm < 8


def test_no_pressure_puts_the_tissue_at_risk(result):
    assert result.summary.mean_pressure_pa < CRITICAL_PRESSURE_PA


def test_the_mesh_stays_sound(result):
    assert result.summary.min_scaled_jacobian > 0.2
