"""A simulation: it lives in the daemon, this is a handle."""

from __future__ import annotations

import time
from contextlib import suppress
from types import TracebackType
from typing import Any, Callable, Iterator, Optional, Sequence, Type, TypeVar

from lipofill.channel import Channel
from lipofill.errors import (
    DeadlineExceededError,
    FailedPreconditionError,
    LipofillError,
    NotFoundError,
    SimulationFailedError,
)
from lipofill.frames import Frame
from lipofill.progress import ProgressCallback, report
from lipofill.series import Series, fetch_series
from lipofill.v1 import geometry_pb2
from lipofill.v1 import simulation_pb2 as messages
from lipofill.v1 import simulation_service_pb2 as pb
from lipofill.watching import Watch, watch_request

_DEFAULT_END_S = 60.0
Self = TypeVar("Self", bound="Simulation")


_ENDED = (
    messages.Simulation.SETTLED,
    messages.Simulation.FINISHED,
    messages.Simulation.STOPPED,
    messages.Simulation.FAILED,
)


def has_ended(simulation: messages.Simulation) -> bool:
    """Whether it is SETTLED, FINISHED, STOPPED or FAILED."""
    return simulation.state in _ENDED


class Simulation:
    """A simulation of the daemon, by its name. It runs on when its client leaves.

    As a context manager it is started when entered, if it is READY, and stopped when left, unless
    it has ended.

    Attributes
    ----------
    name : str
        ``simulations/{simulation}``
    """

    def __init__(self, channel: Channel, name: str) -> None:
        self.name = name if "/" in name else f"simulations/{name}"
        self._channel = channel
        self._stub = channel.simulation_stub

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name} at {self._channel.server}>"

    def __enter__(self: Self) -> Self:
        if self.get().state == messages.Simulation.READY:
            self.start()
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        # It may come to its end between the two calls, or have been deleted.
        with suppress(FailedPreconditionError, NotFoundError):
            if not has_ended(self.get()):
                self.stop()

    def get(self) -> messages.Simulation:
        """As it is now: state, reason, plan and summary."""
        return self._channel.call(self._stub.GetSimulation, pb.GetSimulationRequest(name=self.name))

    def start(self) -> messages.Simulation:
        """FailedPreconditionError unless it is READY."""
        return self._channel.call(self._stub.StartSimulation, pb.StartSimulationRequest(name=self.name))

    def pause(self) -> messages.Simulation:
        """Answers within one step."""
        return self._channel.call(self._stub.PauseSimulation, pb.PauseSimulationRequest(name=self.name))

    def resume(self) -> messages.Simulation:
        """FailedPreconditionError unless it is PAUSED."""
        return self._channel.call(self._stub.ResumeSimulation, pb.ResumeSimulationRequest(name=self.name))

    def stop(self) -> messages.Simulation:
        """Ends it in state STOPPED, keeping what it reached."""
        return self._channel.call(self._stub.StopSimulation, pb.StopSimulationRequest(name=self.name))

    def delete(self) -> None:
        """Stops it first when it runs."""
        self._channel.delete(self._stub.DeleteSimulation, pb.DeleteSimulationRequest(name=self.name))

    def inject(
        self,
        zone: str,
        *,
        volume_ml: float,
        rate_ml_per_s: float,
        start_s: Optional[float] = None,
        site: Optional[geometry_pb2.SkinPoint] = None,
    ) -> messages.Simulation:
        """Adds an injection to a simulation that has not ended, or that has settled: then it goes
        on. By default it starts now, or after those already due.
        """
        injection = messages.Injection(
            zone=zone, volume_ml=volume_ml, rate_ml_per_s=rate_ml_per_s, start_s=start_s, site=site
        )
        return self._channel.call(self._stub.Inject, pb.InjectRequest(name=self.name, injection=injection))

    def checkpoint(self, checkpoint_id: str = "") -> pb.Checkpoint:
        """Keeps its state."""
        request = pb.CreateCheckpointRequest(parent=self.name, checkpoint_id=checkpoint_id)
        return self._channel.call(self._stub.CreateCheckpoint, request)

    def checkpoints(self) -> Iterator[pb.Checkpoint]:
        """Those made by clients and those the daemon makes to go on from after its own end."""
        request = pb.ListCheckpointsRequest(parent=self.name)
        return self._channel.paged(self._stub.ListCheckpoints, request, "checkpoints")

    def restore(self, checkpoint: str) -> messages.Simulation:
        """Goes back to a checkpoint on its course; frames then come in a new epoch."""
        return self._channel.call(self._stub.RestoreSimulation, pb.RestoreSimulationRequest(checkpoint=checkpoint))

    def branch(self, checkpoint: str, *, start: bool = False) -> Simulation:
        """A new simulation that begins from a checkpoint of this one."""
        request = pb.RestoreSimulationRequest(checkpoint=checkpoint, as_new=True, start=start)
        return Simulation(self._channel, self._channel.call(self._stub.RestoreSimulation, request).name)

    def series(self) -> Series:
        """The figures of every step so far."""
        return fetch_series(self._channel, self.name)

    def evaluate(self, target_scan: str) -> pb.Evaluation:
        """Distance of the simulated skin to a target scan, ``patients/{patient}/scans/{scan}``, in
        the same frame [mm].
        """
        request = pb.EvaluateSimulationRequest(name=self.name, target_scan=target_scan)
        return self._channel.call(self._stub.EvaluateSimulation, request)

    def tissue_deck(self) -> bytes:
        """The tissue at rest under the pressure of its films, as an Abaqus/CalculiX input deck."""
        request = pb.ExportTissueDeckRequest(name=self.name)
        stream = self._stub.ExportTissueDeck(request, metadata=self._channel.metadata())
        return b"".join(piece.data for piece in self._channel.stream_items(stream))

    def watch(
        self,
        *,
        patience_s: float = 30.0,
        on_reconnect: Optional[Callable[[LipofillError], object]] = None,
        **choices: Any,
    ) -> Watch:
        """Frames as they are computed, until the simulation ends. Of one that has ended: its last
        frame.

        Parameters
        ----------
        delivery : {"LATEST", "EVERY"}
            LATEST skips frames that the viewer is too slow for and counts them; EVERY has all, and
            gives up a viewer that falls too far behind (the watch then goes on by itself where it
            was).
        meshes : sequence of str
            "skin", "scan", "film/<film>", "tissue"; default: skin and every film.
        fields : sequence of str
            For example "skin.displacement"; default: all.
        interval_ms : float
            Simulated time between frames; default: every step.
        max_rate_hz : float
            LATEST: at most so many frames a second of the clock; 0: no bound; default 60, less of
            many viewers.
        compact : bool
            Half the bytes: 16-bit codes, decoded to float32 with Array.max_error stated.
        acknowledge : int
            At most so many frames are on their way: the next one is then the newest, also after a
            pause of the viewer.
        heartbeat_ms : float
        seen : Frame
            Resume after this frame.
        patience_s : float
            How long to go on trying where the stream breaks.
        on_reconnect : callable
            Told the error of each break.

        Returns
        -------
        Watch
            An iterator over Frame and a context manager.
        """
        request = watch_request(self.name, **choices)
        return Watch(self._channel, request, patience_s=patience_s, on_reconnect=on_reconnect)

    def final_frame(self, *, meshes: Sequence[str] = ()) -> Frame:
        """The last frame of a simulation that has ended; NotFoundError where the daemon keeps
        none.
        """
        last: Optional[Frame] = None
        with self.watch(meshes=meshes) as frames:
            for last in frames:
                pass
        if last is None:
            raise NotFoundError(f"the daemon keeps no final frame of {self.name}")
        return last

    def wait(
        self, *, timeout_s: Optional[float] = None, progress: Optional[ProgressCallback] = None
    ) -> messages.Simulation:
        """Waits until it ends.

        Returns
        -------
        lipofill.v1.Simulation
            SETTLED, FINISHED or STOPPED, with its summary.

        Raises
        ------
        SimulationFailedError
            It could not go on; the message is the reason.
        DeadlineExceededError
            After `timeout_s`; it goes on.
        """
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        pause_s = 0.01
        while not has_ended(now := self.get()):
            end_s = now.spec.time.end_s or _DEFAULT_END_S
            text = f"{now.summary.time_s:.2f} s simulated, {now.summary.injected_ml:.2f} mL injected"
            report(progress, "simulate", now.summary.time_s / end_s, text)
            if deadline is not None and time.monotonic() >= deadline:
                raise DeadlineExceededError(f"{self.name} has not ended after {timeout_s} s")
            time.sleep(pause_s)
            pause_s = min(0.25, 1.5 * pause_s)
        if now.state == messages.Simulation.FAILED:
            raise SimulationFailedError(f"{self.name}: {now.reason}", from_daemon=True)
        report(progress, "simulate", 1.0, messages.Simulation.State.Name(now.state).lower())
        return now
