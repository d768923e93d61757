"""How far something long is."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Callable, Optional


@dataclass(frozen=True)
class Progress:
    """What is being done, and how far it is.

    Attributes
    ----------
    stage : str
        ``"upload"``, ``"build"`` or ``"simulate"``.
    fraction : float
        In [0, 1].
    text : str
        For people.
    """

    stage: str
    fraction: float
    text: str


ProgressCallback = Callable[[Progress], object]


def report(callback: Optional[ProgressCallback], stage: str, fraction: float, text: str) -> None:
    """Calls the callback where there is one."""
    if callback is not None:
        callback(Progress(stage, min(max(fraction, 0.0), 1.0), text))


def print_progress(progress: Progress) -> None:
    """A line on standard error, overwritten by the next on a terminal."""
    on_terminal = sys.stderr.isatty()
    line = f"{progress.stage}: {100 * progress.fraction:3.0f} %  {progress.text}"
    print(f"\r{line:<100.100}" if on_terminal else line, end="" if on_terminal else "\n", file=sys.stderr, flush=True)
