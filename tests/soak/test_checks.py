"""The soak's own parts: what would be found is found, and workloads that are wrong are named."""

import json
import pathlib
import subprocess
import sys

import pytest

import lipofill
from figures import Sample, slope_per_minute
from journal import Journal
from lipofill.v1 import simulation_pb2
from workload import WorkloadError, load

FOLDER = pathlib.Path(__file__).resolve().parent


def samples(life, start_mb, mb_per_minute, seconds=60):
    return [Sample(life, t, start_mb + mb_per_minute * t / 60, 10, 20, 0, 0.0) for t in range(seconds)]


def test_growth_is_found_whatever_each_life_begins_with():
    grows = [*samples(0, 50, 6.0), *samples(1, 90, 6.0), *samples(2, 20, 6.0, seconds=5)]
    slope, used = slope_per_minute(grows, "memory_mb", warm_up_s=10)
    assert slope == pytest.approx(6.0) and used == 100
    assert slope_per_minute([*samples(0, 50, 0.0), *samples(1, 90, 0.0)], "memory_mb", 10)[0] == pytest.approx(0.0)


def test_what_happens_in_the_warm_up_does_not_count():
    assert slope_per_minute(samples(0, 50, 100.0, seconds=10), "memory_mb", warm_up_s=10) == (0.0, 0)


def ended(rows, injected_ml):
    simulation = simulation_pb2.Simulation(state=simulation_pb2.Simulation.FINISHED)
    simulation.summary.steps, simulation.summary.injected_ml = len(rows), injected_ml
    return simulation, lipofill.Series(
        simulation_pb2.SeriesRow(step=i + 1, injected_ml=injected, film_volume_ml=film)
        for i, (injected, film) in enumerate(rows)
    )


@pytest.mark.parametrize(
    "rows, planned, holds",
    [
        ([(0.1, 0.3), (0.2, 0.4)], 0.2, True),
        ([(0.1, 0.3), (0.2, 0.4000001)], 0.2, False),  # fat from nowhere
        ([(0.1, 0.3), (0.2, 0.4)], 0.3, False),  # not all was injected
    ],
)
def test_a_ledger_that_does_not_balance_is_found(rows, planned, holds):
    journal = Journal(1e-9)
    journal.check_ledger("s", *ended(rows, rows[-1][0]), planned)
    assert (journal.counts["complaints"] == 0) == holds


def test_what_came_too_late_need_not_be_injected_but_no_more_than_that():
    for injected, holds in ((0.2, True), (0.23, True), (0.25, True), (0.19, False), (0.26, False)):
        journal = Journal(1e-9)
        journal.check_ledger("s", *ended([(0.1, 0.3), (injected, injected + 0.2)], injected), 0.2, 0.05)
        assert (journal.counts["complaints"] == 0) == holds, injected


def test_another_state_of_the_same_plan_is_found():
    journal = Journal(1e-9)
    journal.note_hash("a", "1")
    journal.note_hash("b", "2")
    assert not journal.complaints
    journal.note_hash("a", "2")
    assert "2 different states" in journal.complaints[0]


@pytest.mark.parametrize("path", sorted((FOLDER / "workloads").glob("*.json")), ids=lambda path: path.stem)
def test_the_workloads_can_be_read(path):
    workload = load(path)
    assert workload.description and workload.runners and workload.viewers
    assert all(runners.plan == "plate" or (path.parent / runners.plan).exists() for runners in workload.runners)


@pytest.mark.parametrize(
    "given, complaint",
    [
        ({"runers": []}, "no field 'runers'"),
        ({"duration_s": "long"}, "duration_s is 'long', not a number"),
        ({"seed": 1.5}, "not a whole number"),
        ({"runners": [{"count": -1}]}, r"runners\[0\].count is -1, must not be negative"),
        ({"viewers": [{"behaviour": "sleep"}]}, r"viewers\[0\].behaviour is 'sleep', not one of follow"),
        ({"kill_every_s": [3]}, r"kill_every_s is \[3.0\], must be \[from, to\]"),
        ({"uploaders": [{"cells": [0, 5]}]}, r"cells is \[0, 5\], must be \[from, to\] in \[2, 1000\]"),
        ({"limits": []}, "limits is \\[\\], not an object"),
    ],
)
def test_a_workload_that_is_wrong_is_named(tmp_path, given, complaint):
    (tmp_path / "wrong.json").write_text(json.dumps(given))
    with pytest.raises(WorkloadError, match=complaint):
        load(tmp_path / "wrong.json")


def test_a_soak_fails_where_a_limit_is_exceeded(tmp_path):
    given = {"duration_s": 1, "runners": [{}], "viewers": [{}], "limits": {"peak_memory_mb": 1}}
    (tmp_path / "tight.json").write_text(json.dumps(given))
    command = [
        sys.executable,
        str(FOLDER / "soak.py"),
        str(tmp_path / "tight.json"),
        "--json",
        str(tmp_path / "out.json"),
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1 and "Traceback" not in done.stderr, done.stderr
    failed = [
        check["name"] for check in json.loads((tmp_path / "out.json").read_text())["checks"] if not check["holds"]
    ]
    assert failed == ["peak memory [MB]"]
