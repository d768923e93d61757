"""What goes wrong, as exceptions that carry what the daemon said: google.rpc.Status with ErrorInfo,
BadRequest and RetryInfo.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional, Sequence, Tuple, Type

import grpc
from google.protobuf.message import DecodeError

from lipofill.google_rpc import error_details_pb2, status_pb2

_DETAILS_KEY = "grpc-status-details-bin"


@dataclass(frozen=True)
class FieldViolation:
    """One thing wrong with one field of a request.

    Attributes
    ----------
    field : str
        Its path in the wire schema, for example ``layers[0].youngs_modulus_kpa``.
    description : str
        A sentence with the value and the bound.
    """

    field: str
    description: str


class LipofillError(Exception):
    """An error of the daemon, or on the way to it.

    Attributes
    ----------
    code : grpc.StatusCode
    message : str
    reason : str
        ErrorInfo.reason, for programs, for example ``"FIELD_VIOLATION"`` or ``"DRAINING"``; empty
        without an ErrorInfo.
    metadata : Mapping[str, str]
        ErrorInfo.metadata.
    violations : tuple of FieldViolation
    retry_delay_s : float or None
        When it makes sense to try again, in seconds from now: RetryInfo. The daemon did not begin
        what was asked.
    from_daemon : bool
        Whether the daemon answered, rather than the connection failing.
    """

    code: grpc.StatusCode = grpc.StatusCode.UNKNOWN

    def __init__(
        self,
        message: str,
        *,
        code: Optional[grpc.StatusCode] = None,
        reason: str = "",
        metadata: Optional[Mapping[str, str]] = None,
        violations: Sequence[FieldViolation] = (),
        retry_delay_s: Optional[float] = None,
        from_daemon: bool = False,
    ) -> None:
        super().__init__(message)
        self.message = message
        if code is not None:
            self.code = code
        self.reason = reason
        self.metadata: Dict[str, str] = dict(metadata or {})
        self.violations: Tuple[FieldViolation, ...] = tuple(violations)
        self.retry_delay_s = retry_delay_s
        self.from_daemon = from_daemon

    def __str__(self) -> str:
        lines = [f"{self.code.name}: {self.message}"]
        lines += [f"  {violation.field}: {violation.description}" for violation in self.violations]
        return "\n".join(lines)


class InvalidArgumentError(LipofillError, ValueError):
    """A field is out of its bounds: see ``violations``."""

    code = grpc.StatusCode.INVALID_ARGUMENT


class NotFoundError(LipofillError):
    """What is named does not exist, or was deleted."""

    code = grpc.StatusCode.NOT_FOUND


class AlreadyExistsError(LipofillError):
    """The id is taken."""

    code = grpc.StatusCode.ALREADY_EXISTS


class FailedPreconditionError(LipofillError):
    """Not in this state."""

    code = grpc.StatusCode.FAILED_PRECONDITION


class ResourceExhaustedError(LipofillError):
    """A limit of the daemon is reached."""

    code = grpc.StatusCode.RESOURCE_EXHAUSTED


class AbortedError(LipofillError):
    """Another took the place, or changed the same thing."""

    code = grpc.StatusCode.ABORTED


class UnavailableError(LipofillError, ConnectionError):
    """No daemon answers, or it is about to end."""

    code = grpc.StatusCode.UNAVAILABLE


class DeadlineExceededError(LipofillError, TimeoutError):
    """No answer in time."""

    code = grpc.StatusCode.DEADLINE_EXCEEDED


class PermissionDeniedError(LipofillError):
    """The caller may not do this."""

    code = grpc.StatusCode.PERMISSION_DENIED


class UnauthenticatedError(LipofillError):
    """The daemon does not know who calls."""

    code = grpc.StatusCode.UNAUTHENTICATED


class CancelledError(LipofillError):
    """The call was cancelled."""

    code = grpc.StatusCode.CANCELLED


class DataLossError(LipofillError):
    """What came is not whole."""

    code = grpc.StatusCode.DATA_LOSS


class SimulationFailedError(LipofillError):
    """The simulation is in state FAILED; the message is its reason."""

    code = grpc.StatusCode.FAILED_PRECONDITION


_CLASSES: Dict[grpc.StatusCode, Type[LipofillError]] = {
    kind.code: kind
    for kind in (
        InvalidArgumentError,
        NotFoundError,
        AlreadyExistsError,
        FailedPreconditionError,
        ResourceExhaustedError,
        AbortedError,
        UnavailableError,
        DeadlineExceededError,
        PermissionDeniedError,
        UnauthenticatedError,
        CancelledError,
        DataLossError,
    )
}
_CODES: Dict[int, grpc.StatusCode] = {code.value[0]: code for code in grpc.StatusCode}


def error_from_status(status: status_pb2.Status) -> LipofillError:
    """A google.rpc.Status, for example of an operation that failed, as an exception of the class of
    its code.
    """
    code = _CODES.get(status.code, grpc.StatusCode.UNKNOWN)
    info, bad_request, retry = (
        error_details_pb2.ErrorInfo(),
        error_details_pb2.BadRequest(),
        error_details_pb2.RetryInfo(),
    )
    retry_delay_s: Optional[float] = None
    for detail in status.details:
        detail.Unpack(info)
        detail.Unpack(bad_request)
        if detail.Unpack(retry):
            retry_delay_s = retry.retry_delay.seconds + 1e-9 * retry.retry_delay.nanos
    return _CLASSES.get(code, LipofillError)(
        status.message,
        code=code,
        reason=info.reason,
        metadata=info.metadata,
        violations=[FieldViolation(each.field, each.description) for each in bad_request.field_violations],
        retry_delay_s=retry_delay_s,
        from_daemon=len(status.details) > 0,
    )


def _status_of(error: Any) -> status_pb2.Status:
    """The details in the trailers where there are any that can be read, with the call's own code
    and message.
    """
    status = status_pb2.Status()
    for key, value in error.trailing_metadata() or ():
        if key == _DETAILS_KEY:
            try:
                status.ParseFromString(value)
            except DecodeError:
                status.Clear()
    status.code = error.code().value[0]
    status.message = error.details() or ""
    return status


def error_from_call(error: Any, server: str) -> LipofillError:
    """A grpc.RpcError of a call to `server` as an exception that says which daemon was asked and
    what to do.
    """
    status = _status_of(error)
    if not status.details and error.code() is grpc.StatusCode.UNAVAILABLE:
        status.message = f"no daemon answers at {server}; start lipofilld or name another ({status.message})"
    elif not status.details and error.code() is grpc.StatusCode.CANCELLED:
        # Calls here are not cancelled by their caller: the daemon ended, and with it what was under
        # way.
        status.code = grpc.StatusCode.UNAVAILABLE.value[0]
        status.message = f"the daemon at {server} ended before it answered"
    elif not status.details and error.code() is grpc.StatusCode.DEADLINE_EXCEEDED:
        status.message = f"the daemon at {server} did not answer in time"
    return error_from_status(status)
