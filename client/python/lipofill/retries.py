"""When a call may be made again: only where it is safe."""

from __future__ import annotations

import re
import time
import uuid
from dataclasses import dataclass, field
from typing import Any, Optional, TypeVar, cast

import grpc

from lipofill.errors import LipofillError

Request = TypeVar("Request")

# Asking again changes nothing; ending or cancelling what is ended or cancelled neither.
_REPEATABLE = re.compile(
    r"((Get|List|Wait|Evaluate|Estimate|Check|Measure|Delete|Cancel|Acknowledge)[A-Z]\w*|PlanDelivery|ArrangeFace|AddPlanRun)Request"
)


@dataclass(frozen=True)
class RetryPolicy:
    """How long a call is made again while the daemon cannot be reached or refuses with a RetryInfo.

    Attributes
    ----------
    patience_s : float
        From the first failure on; 0: not at all.
    first_delay_s, most_delay_s : float
        The pause doubles from the one to the other. A RetryInfo of the daemon is honoured where it
        is longer.
    """

    patience_s: float = 5.0
    first_delay_s: float = 0.05
    most_delay_s: float = 1.0


def with_request_id(request: Request) -> Request:
    """The request with a request_id of its own, where it has the field and none yet: repeated, it
    is carried out once.
    """
    message: Any = request
    if "request_id" not in message.DESCRIPTOR.fields_by_name or message.request_id:
        return request
    named: Any = type(message)()
    named.CopyFrom(message)
    named.request_id = uuid.uuid4().hex
    return cast(Request, named)


def is_safe_to_repeat(request: Any) -> bool:
    """Whether the daemon may get this request twice: it reads, it deletes, or it bears a
    request_id.
    """
    descriptor = request.DESCRIPTOR
    return "request_id" in descriptor.fields_by_name or _REPEATABLE.fullmatch(descriptor.name) is not None


@dataclass
class Attempts:
    """The attempts at one call."""

    policy: RetryPolicy
    is_safe: bool
    made: int = field(default=0, init=False)
    _give_up: Optional[float] = field(default=None, init=False)

    def wait_after(self, error: LipofillError) -> bool:
        """Waits before the next attempt; False where there should be none.

        A RetryInfo says that nothing was begun, so that any call may be made again; a call that was
        not answered may have been carried out.
        """
        if self._give_up is None:
            self._give_up = time.monotonic() + self.policy.patience_s
        unanswered = error.code is grpc.StatusCode.UNAVAILABLE and not error.from_daemon
        if error.retry_delay_s is None and not (unanswered and self.is_safe):
            return False
        delay_s = min(self.policy.first_delay_s * 2**self.made, self.policy.most_delay_s)
        delay_s = max(delay_s, error.retry_delay_s or 0.0)
        if time.monotonic() + delay_s > self._give_up:
            return False
        time.sleep(delay_s)
        self.made += 1
        return True
