#!/usr/bin/env python3
"""Runs a composed workload against the real daemon for a time, and checks what months would show:
see deploy/soak --help.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import pathlib
import sys
import tempfile
import threading
import time
from typing import Any, Dict, List, Tuple

import lipofill
from clients import Client, Reaper, Runner, Uploader, Viewer
from figures import Sample, Sampler, files_below, slope_per_minute
from journal import Journal
from workload import Workload, WorkloadError, load, span_of

JOIN_S = 180.0
TELL_EVERY_S = 15.0


@dataclasses.dataclass
class Check:
    """A figure, its bound, and whether it holds."""

    name: str
    value: float
    bound: float
    at_least: bool = False

    @property
    def holds(self) -> bool:
        return self.value >= self.bound if self.at_least else self.value <= self.bound


class Soak:
    """One workload against one data directory."""

    def __init__(self, workload: Workload, folder: pathlib.Path) -> None:
        self.workload = workload
        self.folder = folder
        self.stop = threading.Event()
        self.lock = threading.Lock()  # one end of the daemon at a time
        self.journal = Journal(workload.limits.ledger_relative_error)
        self.daemon = lipofill.Daemon(folder / "data", workload.daemon_arguments)
        self.left_files = 0
        self.exit_code = 0

    def run(self) -> List[Check]:
        """The whole soak; its checks."""
        self.daemon.start()
        self.sampler = Sampler(self.daemon)
        clients, reapers = self._clients(), self._reapers()
        started = time.monotonic()
        for thread in [*clients, *reapers]:
            thread.start()
        self._wait(started, clients)
        self.stop.set()
        for thread in [*reapers, *clients]:
            thread.join(JOIN_S)
            if thread.is_alive():
                self.journal.complain(f"{thread.name} does not come to its end within {JOIN_S:g} s")
        self.idle_after = self._idle()
        self.sampler.close()
        self._check_nothing_is_left()
        self.exit_code = self.daemon.stop()
        self.seconds = time.monotonic() - started
        return self._checks()

    def _wait(self, started: float, clients: List[Client]) -> None:
        """For the time of the workload, or until every client has given up."""
        next_told_s = TELL_EVERY_S
        while (age_s := time.monotonic() - started) < self.workload.duration_s and any(
            client.is_alive() for client in clients
        ):
            time.sleep(0.1)
            if age_s > next_told_s:
                next_told_s += TELL_EVERY_S
                counts = [f"{self.journal.counts[what]} {what}" for what in ("runs", "frames", "kills", "complaints")]
                print(f"soak: {age_s:5.0f} s  {', '.join(counts)}", file=sys.stderr)

    def _clients(self) -> List[Client]:
        clients: List[Client] = []

        def add(kind: Any, *arguments: Any) -> None:
            name = f"{kind.__name__.lower()} {len(clients)}"
            clients.append(kind(*arguments, name, self.daemon.server, self.journal, self.stop, self.workload.seed))

        for runners in self.workload.runners:
            for _ in range(runners.count):
                add(Runner, runners, self.workload.folder)
        for uploaders in self.workload.uploaders:
            for _ in range(uploaders.count):
                add(Uploader, uploaders, self.folder)
        for viewers in self.workload.viewers:
            for _ in range(viewers.count):
                add(Viewer, viewers)
        return clients

    def _reapers(self) -> List[Reaper]:
        ways = [
            ("kills", self.daemon.kill, span_of(self.workload.kill_every_s)),
            ("restarts", self.daemon.stop, span_of(self.workload.restart_every_s)),
        ]
        return [
            Reaper(self.daemon, end, what, span, self.lock, self.journal, self.stop, self.workload.seed)
            for what, end, span in ways
            if span is not None
        ]

    def _idle(self) -> Sample:
        """Once its threads and files have come down, or after ten seconds."""
        limits, before = self.workload.limits, self.sampler.idle_before
        deadline = time.monotonic() + 10.0
        while True:
            now = self.sampler.now()
            rested = (
                now.threads <= before.threads + limits.idle_threads_more
                and now.open_files <= before.open_files + limits.idle_open_files_more
            )
            if rested or time.monotonic() > deadline:
                return now
            time.sleep(0.2)

    def _check_nothing_is_left(self) -> None:
        """Everything was deleted: no patient, no simulation, and no file of one."""
        with self.daemon.connect() as connection:
            left = [each.name for each in connection.patients.list()] + [
                each.name for each in connection.simulations.list()
            ]
        for name in left:
            self.journal.complain(f"{name} is still there")
        orphans = [file for part in ("scans", "checkpoints") for file in files_below(self.daemon.data / part)]
        self.left_files = len(orphans)
        for file in orphans[:10]:
            self.journal.complain(f"orphan file {file.relative_to(self.daemon.data)}")

    def slope(self, figure: str) -> Tuple[float, int]:
        return slope_per_minute(self.sampler.samples, figure, self.workload.limits.warm_up_s)

    def _checks(self) -> List[Check]:
        limits, samples, before = self.workload.limits, self.sampler.samples, self.sampler.idle_before
        more_threads = self.idle_after.threads - before.threads
        more_files = self.idle_after.open_files - before.open_files
        states = max((len(each) for each in self.journal.hashes.values()), default=1)
        return [
            Check("memory slope [MB/minute]", self.slope("memory_mb")[0], limits.memory_slope_mb_per_minute),
            Check("peak memory [MB]", max(sample.memory_mb for sample in samples), limits.peak_memory_mb),
            Check("peak threads", max(sample.threads for sample in samples), limits.peak_threads),
            Check("threads at rest, more than at first", more_threads, limits.idle_threads_more),
            Check("peak open files", max(sample.open_files for sample in samples), limits.peak_open_files),
            Check("open files at rest, more than at first", more_files, limits.idle_open_files_more),
            Check("orphan files", self.left_files, 0),
            Check("worst volume ledger, relative", self.journal.worst_ledger, limits.ledger_relative_error),
            Check("states of a plan", states, 1),
            Check("runs", self.journal.counts["runs"], limits.least_runs, at_least=True),
            Check("complaints", self.journal.counts["complaints"], 0),
            Check("exit code of the daemon", abs(self.exit_code), 0),
        ]


def report(soak: Soak, checks: List[Check]) -> Dict[str, Any]:
    """What the JSON has."""
    return {
        "description": soak.workload.description,
        "seconds": round(soak.seconds, 1),
        "seed": soak.workload.seed,
        "passed": all(check.holds for check in checks),
        "checks": [{**dataclasses.asdict(check), "holds": check.holds} for check in checks],
        "counts": dict(sorted(soak.journal.counts.items())),
        "plans": {plan: dict(states) for plan, states in sorted(soak.journal.hashes.items())},
        "complaints": soak.journal.complaints,
        "idle_before": dataclasses.asdict(soak.sampler.idle_before),
        "idle_after": dataclasses.asdict(soak.idle_after),
        "memory_samples": soak.slope("memory_mb")[1],
        "peak_data_mb": max(sample.data_mb for sample in soak.sampler.samples),
    }


def print_table(content: Dict[str, Any]) -> None:
    print(f"\n{content['description']}\n{content['seconds']:.0f} s, seed {content['seed']}\n")
    for check in content["checks"]:
        relation = ">=" if check["at_least"] else "<="
        outcome = "ok    " if check["holds"] else "FAILED"
        print(f"  {outcome} {check['name']:<40} {check['value']:>12.4g} {relation} {check['bound']:g}")
    print()
    for what, times in content["counts"].items():
        print(f"  {times:>12}  {what}")
    for complaint in content["complaints"]:
        print(f"  complaint: {complaint}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("workload", type=pathlib.Path)
    parser.add_argument("--duration-s", type=float, help="in place of the workload's")
    parser.add_argument("--seed", type=int, help="in place of the workload's")
    parser.add_argument("--json", type=pathlib.Path, help="where to write the figures")
    parser.add_argument("--keep", type=pathlib.Path, help="where to leave data and log; default: nowhere")
    arguments = parser.parse_args()
    try:
        workload = load(arguments.workload)
    except WorkloadError as error:
        print(f"soak: {error}", file=sys.stderr)
        return 2
    workload.duration_s = workload.duration_s if arguments.duration_s is None else arguments.duration_s
    workload.seed = workload.seed if arguments.seed is None else arguments.seed
    with tempfile.TemporaryDirectory(prefix="lipofill-soak-") as folder:
        soak = Soak(workload, arguments.keep or pathlib.Path(folder))
        soak.folder.mkdir(parents=True, exist_ok=True)
        checks = soak.run()
        if arguments.keep:
            (soak.folder / "log").write_text(soak.daemon.log())
    content = report(soak, checks)
    print_table(content)
    if arguments.json:
        arguments.json.write_text(json.dumps(content, indent=1) + "\n")
    sys.stdout.flush()
    # Clients that hang must not keep a failed soak from ending.
    os._exit(0 if content["passed"] else 1)


if __name__ == "__main__":
    sys.exit(main())
