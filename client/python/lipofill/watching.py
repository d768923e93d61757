"""Watching a simulation: frames as they come, also across a daemon that ends and comes back."""

from __future__ import annotations

import time
import uuid
from types import TracebackType
from typing import Callable, Iterator, Literal, Optional, Sequence, Type

import grpc

from lipofill.channel import Channel
from lipofill.errors import (
    DeadlineExceededError,
    LipofillError,
    ResourceExhaustedError,
    UnavailableError,
    error_from_call,
)
from lipofill.frames import Frame, Meshes, StreamAssembler
from lipofill.rpc_types import ResponseStream
from lipofill.silence import SilenceWatch
from lipofill.v1 import frame_service_pb2 as pb

_SILENT_HEARTBEATS = 4
_DEFAULT_HEARTBEAT_MS = 10_000.0


def watch_request(
    simulation: str,
    *,
    delivery: Literal["LATEST", "EVERY"] = "LATEST",
    meshes: Sequence[str] = (),
    fields: Sequence[str] = (),
    interval_ms: Optional[float] = None,
    max_rate_hz: Optional[float] = None,
    compact: bool = False,
    acknowledge: int = 0,
    heartbeat_ms: Optional[float] = None,
    seen: Optional[Frame] = None,
) -> pb.WatchRequest:
    """What Simulation.watch takes, as a message."""
    request = pb.WatchRequest(
        simulation=simulation,
        delivery=pb.WatchRequest.Delivery.Value(delivery),
        meshes=meshes,
        fields=fields,
        interval_ms=interval_ms,
        max_rate_hz=max_rate_hz,
        field_type=pb.UINT16 if compact else pb.FLOAT32,
        heartbeat_ms=heartbeat_ms,
        max_unacknowledged_frames=acknowledge,
    )
    if acknowledge > 0:
        request.viewer = "v" + uuid.uuid4().hex
    if seen is not None:
        request.seen_epoch, request.seen_sequence = seen.epoch, seen.sequence
    return request


class Watch:
    """Iterates over frames. A context manager: entering it opens the stream, leaving it closes it.

        run = channel.run(plan)
        with run.watch(delivery="EVERY", meshes=["skin"]) as frames, run:  # watched before it starts: none is missed
            for frame in frames:
                print(frame.time_s, frame["skin.displacement"].max())

    A stream that breaks (the daemon ends and comes back, or drops a viewer that fell behind) is
    taken up again after the last frame that came, by epoch and sequence, for `patience_s` without a
    frame. Meshes come once; who has them by their hash gets none. A daemon that is silent for four
    heartbeats counts as a broken stream. With acknowledgements, a frame is taken once the next one
    is asked for.

    Raises
    ------
    AbortedError
        Another viewer took this one's name.
    LipofillError
        What the daemon refuses, or the way to it once `patience_s` has passed.
    """

    def __init__(
        self,
        channel: Channel,
        request: pb.WatchRequest,
        *,
        patience_s: float = 30.0,
        on_reconnect: Optional[Callable[[LipofillError], object]] = None,
    ) -> None:
        self._channel = channel
        self._request = request
        self._patience_s = patience_s
        self._on_reconnect = on_reconnect
        self._stream: Optional[ResponseStream[pb.WatchResponse]] = None
        self._silence: Optional[SilenceWatch] = None
        self._to_acknowledge: Optional[Frame] = None
        self._seen_any = False
        self._ended = False
        self._broken_since: Optional[float] = None
        self._came_first: Optional[pb.WatchResponse] = None
        self._assembler = StreamAssembler(channel.topologies.get(request))

    @property
    def meshes(self) -> Meshes:
        """The meshes of the frames that come; empty before the first."""
        return self._assembler.meshes

    def __enter__(self) -> Watch:
        """Opens the stream and waits for the first message: from then on every frame is the
        viewer's.
        """
        while self._stream is None:
            try:
                self._came_first = self._receive()
            except LipofillError as error:
                self._close_stream()
                self._resume_after(error)
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.close()

    def __iter__(self) -> Iterator[Frame]:
        return self

    def __next__(self) -> Frame:
        while not self._ended:
            try:
                self._acknowledge()
                frame = self._next_of_stream()
            except LipofillError as error:
                self._close_stream()
                self._resume_after(error)
                continue
            if frame is None:
                self.close()
                break
            self._took(frame)
            return frame
        raise StopIteration

    def close(self) -> None:
        """Ends the stream; no more frames come."""
        self._ended = True
        self._close_stream()

    def _open(self) -> ResponseStream[pb.WatchResponse]:
        self._request.known_topology_hash = self._assembler.meshes.topology_hash
        self._assembler = StreamAssembler(self._assembler.meshes)
        stream = self._channel.frame_stub.Watch(self._request, metadata=self._channel.metadata())
        heartbeat_ms = self._request.heartbeat_ms if self._request.HasField("heartbeat_ms") else _DEFAULT_HEARTBEAT_MS
        self._silence = SilenceWatch(_SILENT_HEARTBEATS * heartbeat_ms / 1e3, stream.cancel)
        self._stream = stream
        return stream

    def _close_stream(self) -> None:
        if self._silence is not None:
            self._silence.close()
        if self._stream is not None:
            self._stream.cancel()
        self._stream = self._silence = self._came_first = None

    def _receive(self) -> Optional[pb.WatchResponse]:
        """The next message; none at the end of the stream."""
        stream = self._stream or self._open()
        assert self._silence is not None
        try:
            with self._silence:
                return next(stream)
        except StopIteration:
            return None
        except grpc.RpcError as error:
            if self._silence.was_silent:
                raise UnavailableError(f"nothing came from {self._channel.server}, not even a heartbeat") from None
            raise error_from_call(error, self._channel.server) from None

    def _next_of_stream(self) -> Optional[Frame]:
        """The next frame; none at the end of the stream."""
        while True:
            response, self._came_first = self._came_first or self._receive(), None
            frame = None if response is None else self._assembler.add(response)
            if response is None or frame is not None:
                return frame

    def _took(self, frame: Frame) -> None:
        self._request.seen_epoch, self._request.seen_sequence = frame.epoch, frame.sequence
        self._channel.topologies.remember(self._request, frame.meshes)
        self._seen_any, self._broken_since = True, None
        if self._request.max_unacknowledged_frames > 0 and not frame.end:
            self._to_acknowledge = frame

    def _acknowledge(self) -> None:
        frame, self._to_acknowledge = self._to_acknowledge, None
        if frame is None:
            return
        try:
            self._channel.call(
                self._channel.frame_stub.AcknowledgeFrame,
                pb.AcknowledgeFrameRequest(
                    simulation=self._request.simulation,
                    viewer=self._request.viewer,
                    epoch=frame.epoch,
                    sequence=frame.sequence,
                ),
            )
        except (UnavailableError, DeadlineExceededError) as error:
            raise UnavailableError(error.message) from None
        except LipofillError as error:
            # The viewer may be gone with its stream, which then says why; a request that is wrong
            # is told.
            if error.code in (grpc.StatusCode.INVALID_ARGUMENT, grpc.StatusCode.PERMISSION_DENIED):
                raise

    def _resume_after(self, error: LipofillError) -> None:
        """Waits before the stream is opened anew; raises where it should not be."""
        patience_s = self._patience_s if self._seen_any else self._channel.retry.patience_s
        fell_behind = isinstance(error, ResourceExhaustedError) and (self._seen_any or error.retry_delay_s is not None)
        now = time.monotonic()
        if self._broken_since is None:
            self._broken_since = now
        broken_for_s = now - self._broken_since
        if not (fell_behind or isinstance(error, UnavailableError)) or broken_for_s > patience_s:
            self._ended = True
            raise error
        if self._on_reconnect is not None:
            self._on_reconnect(error)
        time.sleep(max(error.retry_delay_s or 0.0, min(1.0, 0.05 + 0.5 * broken_for_s)))
