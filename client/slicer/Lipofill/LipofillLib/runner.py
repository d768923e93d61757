"""A run in the background, so that Slicer stays awake: news go through a queue."""

from __future__ import annotations

import queue
import threading
from dataclasses import dataclass
from typing import List, Optional, Union

import lipofill
from lipofill.v1 import simulation_pb2
from LipofillLib.motion import Motion, Still

FRAMES_A_SECOND = 10.0
FIELDS = ("scan.displacement", "scan.pressure")


@dataclass(frozen=True)
class Progressed:
    """How far it has come: a stage, a share from 0 to 1, and words for people."""

    stage: str
    fraction: float
    text: str


@dataclass(frozen=True)
class Began:
    """The skin at rest has come; Moved brings its stills."""

    motion: Motion


@dataclass(frozen=True)
class Moved:
    """The skin moved."""

    still: Still


@dataclass(frozen=True)
class Ended:
    """It came to its end, with its figures."""

    simulation: simulation_pb2.Simulation


@dataclass(frozen=True)
class Failed:
    """It could not be carried out; `message` says why, with the fields that are wrong."""

    message: str


@dataclass(frozen=True)
class Cancelled:
    """It was cancelled, and what it had made on the daemon is gone."""


News = Union[Progressed, Began, Moved, Ended, Failed, Cancelled]


class _Interrupted(Exception):
    """Raised in callbacks of the client to end what it is doing."""


def explain(error: Exception) -> str:
    """An error for people: the message, then a line for every field that is wrong."""
    violations = [f"{each.field}: {each.description}" for each in getattr(error, "violations", ())]
    return "\n".join([str(error).split("\n")[0], *violations])


class Runner:
    """Carries a plan out on a daemon in a thread of its own.

    `take` gives what has happened since it was last asked; the last of all news is Ended, Failed or
    Cancelled. What was made on the daemon is deleted in the end.
    """

    def __init__(self, plan: lipofill.Plan, server: Optional[str]) -> None:
        self._plan = plan
        self._server = server
        self._news: "queue.SimpleQueue[News]" = queue.SimpleQueue()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._carry_out, name="lipofill-run", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def cancel(self) -> None:
        """Asks it to end; Cancelled follows."""
        self._stop.set()

    def is_alive(self) -> bool:
        return self._thread.is_alive()

    def join(self, timeout_s: Optional[float] = None) -> None:
        self._thread.join(timeout_s)

    def take(self) -> List[News]:
        news = []
        while not self._news.empty():
            news.append(self._news.get())
        return news

    def _carry_out(self) -> None:
        try:
            with lipofill.Connection(self._server) as connection:
                run = connection.run(self._plan, progress=self._tell)
                self._news.put(Ended(self._watch(run)))
        except _Interrupted:
            self._news.put(Cancelled())
        except Exception as error:
            # Whatever it is, the panel has to hear of it: nobody else looks at this thread.
            self._news.put(Failed(explain(error)))

    def _tell(self, progress: lipofill.Progress) -> None:
        if self._stop.is_set():
            raise _Interrupted
        self._news.put(Progressed(progress.stage, progress.fraction, progress.text))

    def _watch(self, run: lipofill.Run) -> simulation_pb2.Simulation:
        """Waits for the end while frames come in a second thread: a long step would otherwise keep
        a cancelled run waiting for its next frame.
        """
        problems: List[Exception] = []
        with run:
            frames = run.watch(meshes=["scan"], fields=list(FIELDS), max_rate_hz=FRAMES_A_SECOND)
            watcher = threading.Thread(target=self._show, args=(frames, problems), daemon=True)
            watcher.start()
            result = run.wait(progress=self._tell)
            watcher.join()
        if problems:
            raise problems[0]
        return result

    def _show(self, frames: lipofill.Watch, problems: List[Exception]) -> None:
        began = False
        try:
            with frames:
                for frame in frames:
                    if not began:
                        began = True
                        self._news.put(Began(Motion(frame.meshes["scan.points"], frame.meshes["scan.cells"])))
                    self._news.put(Moved(Still(frame.time_s, frame[FIELDS[0]], frame[FIELDS[1]])))
        except Exception as error:
            problems.append(error)
