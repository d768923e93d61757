"""Workload files: what is done to the daemon, for how long, and what it may cost.
`deploy/soak --help` explains them.
"""

from __future__ import annotations

import dataclasses
import json
import pathlib
import typing
from typing import Any, Dict, List, Optional, Tuple

DELIVERIES = ("LATEST", "EVERY")
BEHAVIOURS = ("follow", "slow", "stall", "leave", "killed", "frozen")


class WorkloadError(ValueError):
    """A workload file that cannot be used: names the file, the field and what it may be."""


@dataclasses.dataclass
class Runners:
    """Clients that carry out plans, one after the other."""

    count: int = 1
    plan: str = "plate"  # "plate", or a plan file relative to the workload
    volumes_ml: List[float] = dataclasses.field(default_factory=lambda: [0.1, 0.2, 0.3])  # of the first injection
    pause_s: float = 0.1  # between runs, at most
    rebuild_share: float = 0.2  # of runs that get a patient, a scan and a model of their own
    inject_share: float = 0.2  # of runs that get more while they run
    checkpoint_share: float = 0.2  # of runs whose state is kept, and which may go back to it
    pause_share: float = 0.2  # of runs that are paused and resumed
    stop_share: float = 0.1  # of runs that are stopped before their end


@dataclasses.dataclass
class Uploaders:
    """Clients that upload scans and delete them, keeping the last few."""

    count: int = 1
    cells: List[int] = dataclasses.field(
        default_factory=lambda: [20, 120]
    )  # a sheet of n x n x 2 triangles, from and to
    keep: int = 3
    pause_s: float = 0.5


@dataclasses.dataclass
class Viewers:
    """Clients that watch whatever runs."""

    count: int = 1
    delivery: str = "LATEST"
    behaviour: str = "follow"


@dataclasses.dataclass
class Limits:
    """What fails the soak when it is exceeded."""

    warm_up_s: float = 5.0  # of each life of the daemon: not in the slope
    memory_slope_mb_per_minute: float = 5.0
    peak_memory_mb: float = 1000.0
    peak_threads: int = 200
    peak_open_files: int = 500
    idle_threads_more: int = 8  # at the end, with nothing to do, than at the start
    idle_open_files_more: int = 8
    ledger_relative_error: float = 1e-9
    least_runs: int = 1


@dataclasses.dataclass
class Workload:
    """A file of tests/soak/workloads."""

    description: str = ""
    duration_s: float = 60.0
    seed: int = 1
    daemon_arguments: List[str] = dataclasses.field(default_factory=list)
    runners: List[Runners] = dataclasses.field(default_factory=list)
    uploaders: List[Uploaders] = dataclasses.field(default_factory=list)
    viewers: List[Viewers] = dataclasses.field(default_factory=list)
    kill_every_s: List[float] = dataclasses.field(
        default_factory=list
    )  # SIGKILL and a new start; from and to; empty: never
    restart_every_s: List[float] = dataclasses.field(default_factory=list)  # SIGTERM and a new start
    limits: Limits = dataclasses.field(default_factory=Limits)
    folder: pathlib.Path = pathlib.Path(".")


_SECTIONS: Dict[str, Any] = {"runners": Runners, "uploaders": Uploaders, "viewers": Viewers}


def _check_number(where: str, value: Any, kind: type) -> Any:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or (kind is int and not float(value).is_integer()):
        raise WorkloadError(f"{where} is {value!r}, not {'a whole number' if kind is int else 'a number'}")
    if value < 0:
        raise WorkloadError(f"{where} is {value}, must not be negative")
    return kind(value)


def _value(where: str, value: Any, kind: Any) -> Any:
    if kind in (int, float):
        return _check_number(where, value, kind)
    if kind is str and not isinstance(value, str):
        raise WorkloadError(f"{where} is {value!r}, not a text")
    if typing.get_origin(kind) is list:
        if not isinstance(value, list):
            raise WorkloadError(f"{where} is {value!r}, not a list")
        (each,) = typing.get_args(kind)
        return [_value(f"{where}[{i}]", item, each) for i, item in enumerate(value)]
    if dataclasses.is_dataclass(kind):
        return _section(where, value, kind)
    return value


def _section(where: str, given: Any, kind: Any) -> Any:
    if not isinstance(given, dict):
        raise WorkloadError(f"{where} is {given!r}, not an object")
    kinds = {name: each for name, each in typing.get_type_hints(kind).items() if name != "folder"}
    unknown = sorted(set(given) - set(kinds))
    if unknown:
        raise WorkloadError(f"{where}: no field '{unknown[0]}'; there are {', '.join(kinds)}")
    return kind(**{name: _value(f"{where}.{name}", value, kinds[name]) for name, value in given.items()})


def _check(workload: Workload, source: str) -> None:
    for name in ("kill_every_s", "restart_every_s"):
        span = getattr(workload, name)
        if span and (len(span) != 2 or span[0] > span[1]):
            raise WorkloadError(f"{source}.{name} is {span}, must be [from, to]")
    for i, viewers in enumerate(workload.viewers):
        for name, choices in (("delivery", DELIVERIES), ("behaviour", BEHAVIOURS)):
            if getattr(viewers, name) not in choices:
                raise WorkloadError(
                    f"{source}.viewers[{i}].{name} is '{getattr(viewers, name)}', not one of {', '.join(choices)}"
                )
    for i, uploaders in enumerate(workload.uploaders):
        if len(uploaders.cells) != 2 or not 2 <= uploaders.cells[0] <= uploaders.cells[1] <= 1000:
            raise WorkloadError(f"{source}.uploaders[{i}].cells is {uploaders.cells}, must be [from, to] in [2, 1000]")


def load(path: pathlib.Path) -> Workload:
    """Reads a workload file; WorkloadError for what is wrong with it."""
    try:
        given = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise WorkloadError(f"{path}: {error}") from None
    workload = _section(path.name, given, Workload)
    _check(workload, path.name)
    workload.folder = path.resolve().parent
    return workload


def span_of(values: List[float]) -> Optional[Tuple[float, float]]:
    """From and to; None where it never happens."""
    return (values[0], values[1]) if values else None
