"""The real daemon of the build tree, on a socket of its own, for all tests of a file."""

import os
import pathlib
from typing import Iterator

import pytest

import lipofill

SOURCE = pathlib.Path(os.environ["LIPOFILL_SOURCE"])
PLANS = SOURCE / "client" / "examples" / "plans"


def make_plate(end_s: float = 0.3, volume_ml: float = 0.3) -> lipofill.Plan:
    """A small soft plate over bone, a film in its middle."""
    plan = lipofill.Plan("plate").square(40, 40, n_xi=12, n_eta=12)
    plan.layer("skin", thickness_mm=3, youngs_modulus_kpa=60, poisson_ratio=0.45, density_kg_m3=1100)
    plan.film("deep", below="skin", n_xi=6, n_eta=6, zones={"middle": lipofill.box(0.16, 0.84, 0.16, 0.84)})
    plan.inject("middle", volume_ml=volume_ml, rate_ml_per_s=1.0, site=lipofill.at_chart(0.5, 0.5))
    plan.simulation.time.step_ms, plan.simulation.time.end_s = 10, end_s
    plan.simulation.time.settle_skin_speed_mm_per_s = 0
    return plan


@pytest.fixture(scope="module")
def daemon() -> Iterator[lipofill.Daemon]:
    with lipofill.Daemon(arguments=["--workers", "2"]) as running:
        yield running


@pytest.fixture(scope="module")
def connection(daemon: lipofill.Daemon) -> Iterator[lipofill.Connection]:
    with daemon.connect() as open_connection:
        yield open_connection


@pytest.fixture
def plate() -> lipofill.Plan:
    return make_plate()
