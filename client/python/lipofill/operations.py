"""Work that takes longer than a call should."""

from __future__ import annotations

from typing import TYPE_CHECKING, Iterator, Optional

from google.protobuf.duration_pb2 import Duration

from lipofill.errors import error_from_status
from lipofill.progress import ProgressCallback, report
from lipofill.v1 import operation_service_pb2 as pb

if TYPE_CHECKING:
    from lipofill.connection import Connection

_WAIT_S = 5


class Operations:
    """The operations of a daemon."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._stub = connection.operation_stub

    def get(self, name: str) -> pb.Operation:
        return self._connection.call(self._stub.GetOperation, pb.GetOperationRequest(name=name))

    def list(self) -> Iterator[pb.Operation]:
        """Those the daemon still knows, by name."""
        return self._connection.paged(self._stub.ListOperations, pb.ListOperationsRequest(), "operations")

    def cancel(self, name: str) -> None:
        """Asks it to stop; it ends with CANCELLED and leaves nothing behind."""
        self._connection.call(self._stub.CancelOperation, pb.CancelOperationRequest(name=name))

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
            operation = self._connection.call(self._stub.WaitOperation, request)
        if operation.HasField("error"):
            raise error_from_status(operation.error)
        report(progress, "build", 1.0, operation.stage)
        return operation
