"""Work that takes longer than a call should."""

from __future__ import annotations

from typing import Iterator, Optional

from google.protobuf.duration_pb2 import Duration

from lipofill.channel import Channel
from lipofill.errors import error_from_status
from lipofill.progress import ProgressCallback, report
from lipofill.v1 import operation_service_pb2 as pb

_WAIT_S = 5


class Operations:
    """The operations of a daemon."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._stub = channel.operation_stub

    def get(self, name: str) -> pb.Operation:
        return self._channel.call(self._stub.GetOperation, pb.GetOperationRequest(name=name))

    def list(self) -> Iterator[pb.Operation]:
        """Those the daemon still knows, by name."""
        return self._channel.paged(self._stub.ListOperations, pb.ListOperationsRequest(), "operations")

    def cancel(self, name: str) -> None:
        """Asks it to stop; it ends with CANCELLED and leaves nothing behind."""
        self._channel.call(self._stub.CancelOperation, pb.CancelOperationRequest(name=name))

    def wait(self, operation: pb.Operation, *, progress: Optional[ProgressCallback] = None) -> pb.Operation:
        """Waits until it is done.

        Raises
        ------
        LipofillError
            The operation's own error.
        """
        while not operation.done:
            report(progress, "build", operation.progress, operation.stage)
            request = pb.WaitOperationRequest(
                name=operation.name, timeout=Duration(seconds=_WAIT_S), seen_progress=operation.progress
            )
            operation = self._channel.call(self._stub.WaitOperation, request)
        if operation.HasField("error"):
            raise error_from_status(operation.error)
        report(progress, "build", 1.0, operation.stage)
        return operation
