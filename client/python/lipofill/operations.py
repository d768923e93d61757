"""Work that takes longer than a call should."""

from __future__ import annotations

from typing import Callable, Iterator, Optional, TypeVar

from google.protobuf.duration_pb2 import Duration
from google.protobuf.message import Message

from lipofill.channel import Channel
from lipofill.errors import LipofillError, NotFoundError, UnavailableError, error_from_status
from lipofill.progress import ProgressCallback, report
from lipofill.v1 import operation_service_pb2 as pb

_WAIT_S = 5
_MOST_RESTARTS = 10

Result = TypeVar("Result", bound=Message)


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

    def carry_out(
        self,
        begin: Callable[[], pb.Operation],
        result: Result,
        *,
        doing: str,
        progress: Optional[ProgressCallback] = None,
    ) -> Result:
        """Begins work, waits for it and fills in its result. An interruption (Ctrl-C, an exception
        of `progress`) cancels the work too. Work that went with a daemon which ended is begun anew:
        the request of `begin` has a request_id, so that what it made before is found.

        Parameters
        ----------
        doing : str
            What the daemon did, for messages: "built the model".
        """
        for _ in range(_MOST_RESTARTS):
            done = self._wait_or_cancel(begin(), progress)
            if done is None:
                continue
            if not done.response.Unpack(result):
                raise LipofillError(f"operation {done.name} ended without a {result.DESCRIPTOR.name.lower()}")
            return result
        raise UnavailableError(f"the daemon ended again and again while it {doing}")

    def _wait_or_cancel(self, operation: pb.Operation, progress: Optional[ProgressCallback]) -> Optional[pb.Operation]:
        """None where the operation went with a daemon that ended."""
        try:
            return self.wait(operation, progress=progress)
        except NotFoundError as error:
            if error.from_daemon and operation.name in error.message:
                return None
            raise
        except LipofillError:
            raise
        except BaseException:
            self.cancel(operation.name)
            raise
