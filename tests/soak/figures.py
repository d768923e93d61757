"""What the daemon takes of the machine, sampled from /proc, and how that grows."""

from __future__ import annotations

import os
import pathlib
import threading
import time
from dataclasses import dataclass
from typing import Dict, List, Tuple

import numpy as np

import lipofill

INTERVAL_S = 0.5


@dataclass(frozen=True)
class Sample:
    """At one moment of one life of the daemon."""

    life: int
    age_s: float
    memory_mb: float
    threads: int
    open_files: int
    data_files: int
    data_mb: float


def files_below(folder: pathlib.Path) -> List[pathlib.Path]:
    """All files, also those that go while they are looked for."""
    return [pathlib.Path(root) / name for root, _, names in os.walk(folder) for name in names]


def _size(file: pathlib.Path) -> int:
    try:
        return file.stat().st_size
    except FileNotFoundError:
        return 0


def take_sample(daemon: lipofill.Daemon, life: int, age_s: float) -> Sample:
    """Raises OSError when the daemon ends meanwhile."""
    process = pathlib.Path("/proc") / str(daemon.pid)
    status = dict(line.split(":", 1) for line in (process / "status").read_text().splitlines())
    open_files = len(os.listdir(process / "fd"))
    files = files_below(daemon.data)
    size = sum(_size(file) for file in files)
    return Sample(
        life, age_s, int(status["VmRSS"].split()[0]) / 1024, int(status["Threads"]), open_files, len(files), size / 1e6
    )


class Sampler:
    """Samples a daemon twice a second until closed, and once more then."""

    def __init__(self, daemon: lipofill.Daemon) -> None:
        self._daemon = daemon
        self._life = 0
        self._pid = daemon.pid
        self._born = time.monotonic()
        self._closed = threading.Event()
        self.samples: List[Sample] = []
        self.idle_before = take_sample(daemon, 0, 0.0)
        self._thread = threading.Thread(target=self._run, name="sampler", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._closed.set()
        self._thread.join()

    def now(self) -> Sample:
        return take_sample(self._daemon, self._life, time.monotonic() - self._born)

    def _run(self) -> None:
        is_last = False
        while not is_last:
            is_last = self._closed.wait(INTERVAL_S)
            if self._daemon.pid != self._pid:
                self._life, self._pid, self._born = self._life + 1, self._daemon.pid, time.monotonic()
            try:
                self.samples.append(self.now())
            except (OSError, KeyError):
                continue  # between two lives


def slope_per_minute(samples: List[Sample], figure: str, warm_up_s: float) -> Tuple[float, int]:
    """Growth of a figure while the daemon lives, by least squares with a level of its own for each
    life after its warm-up.

    Returns the slope a minute and from how many samples; 0 and 0 where no life was long enough.
    """
    lives: Dict[int, List[Sample]] = {}
    for sample in samples:
        if sample.age_s >= warm_up_s:
            lives.setdefault(sample.life, []).append(sample)
    above, below, used = 0.0, 0.0, 0
    for life in lives.values():
        ages = np.array([sample.age_s for sample in life]) / 60
        values = np.array([getattr(sample, figure) for sample in life], dtype=float)
        above += float(((ages - ages.mean()) * (values - values.mean())).sum())
        below += float(((ages - ages.mean()) ** 2).sum())
        used += len(life)
    return (above / below, used) if below > 0 else (0.0, 0)
