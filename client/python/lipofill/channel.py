"""How calls reach a daemon: its services, who calls, attempts that are made again, pages."""

from __future__ import annotations

import os
import warnings
from types import TracebackType
from typing import Any, Iterator, List, Optional, Tuple, Type, TypeVar

import grpc

from lipofill.credentials import Credentials, is_local
from lipofill.errors import LipofillError, NotFoundError, error_from_call
from lipofill.retries import Attempts, RetryPolicy, is_safe_to_repeat, with_request_id
from lipofill.rpc_types import ResponseStream, UnaryUnary
from lipofill.topologies import Topologies
from lipofill.v1 import (
    forecast_service_pb2_grpc,
    frame_service_pb2_grpc,
    operation_service_pb2_grpc,
    patient_service_pb2_grpc,
    plan_service_pb2_grpc,
    planning_service_pb2_grpc,
    simulation_service_pb2_grpc,
)

DEFAULT_SERVER = "127.0.0.1:50061"
DEFAULT_TIMEOUT_S = 60.0

Self = TypeVar("Self", bound="Channel")
Request = TypeVar("Request")
Response = TypeVar("Response")


def _channel_options(server: str) -> List[Tuple[str, Any]]:
    options: List[Tuple[str, Any]] = [
        # A frozen daemon is seen only through keepalive.
        ("grpc.keepalive_time_ms", 60_000),
        ("grpc.keepalive_timeout_ms", 20_000),
        ("grpc.initial_reconnect_backoff_ms", 100),
        ("grpc.min_reconnect_backoff_ms", 1_000),
        ("grpc.max_reconnect_backoff_ms", 1_000),
    ]
    # A daemon of this machine is never behind a proxy.
    return [*options, ("grpc.enable_http_proxy", 0)] if is_local(server) else options


class Channel:
    """What a Connection stands on, without the collections: they use it and it knows nothing of
    them. Thread-safe.
    """

    def __init__(
        self,
        server: Optional[str] = None,
        *,
        credentials: Optional[Credentials] = None,
        retry: RetryPolicy = RetryPolicy(),
        timeout_s: float = DEFAULT_TIMEOUT_S,
    ) -> None:
        self.server = server or os.environ.get("LIPOFILL_SERVER") or DEFAULT_SERVER
        self.retry = retry
        self.timeout_s = timeout_s
        self.topologies = Topologies()
        self._credentials = credentials or Credentials.from_environment()
        self._grpc = self._credentials.open_channel(self.server, _channel_options(self.server))
        self.patient_stub = patient_service_pb2_grpc.PatientServiceStub(self._grpc)
        self.forecast_stub = forecast_service_pb2_grpc.ForecastServiceStub(self._grpc)
        self.plan_stub = plan_service_pb2_grpc.PlanServiceStub(self._grpc)
        self.planning_stub = planning_service_pb2_grpc.PlanningServiceStub(self._grpc)
        self.simulation_stub = simulation_service_pb2_grpc.SimulationServiceStub(self._grpc)
        self.frame_stub = frame_service_pb2_grpc.FrameServiceStub(self._grpc)
        self.operation_stub = operation_service_pb2_grpc.OperationServiceStub(self._grpc)

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connection. What runs on the daemon runs on."""
        self._grpc.close()

    @property
    def credentials(self) -> Credentials:
        """What protects the way to the daemon and says who calls."""
        return self._credentials

    def metadata(self) -> List[Tuple[str, str]]:
        """What goes with every call: who calls."""
        return self._credentials.metadata()

    def call(
        self, method: UnaryUnary[Request, Response], request: Request, *, timeout_s: Optional[float] = None
    ) -> Response:
        """One request, one response; made again while the daemon is away, where that is safe.

            connection.call(connection.simulation_stub.GetSeries, GetSeriesRequest(name=name))

        Raises
        ------
        LipofillError
            Of the class of its code, with the violations and the ErrorInfo.
        """
        request = with_request_id(request)
        attempts = Attempts(self.retry, is_safe_to_repeat(request))
        while True:
            try:
                return method(request, timeout=timeout_s or self.timeout_s, metadata=self.metadata())
            except grpc.RpcError as problem:
                error = error_from_call(problem, self.server)
            if not attempts.wait_after(error):
                raise error from None

    def delete(self, method: UnaryUnary[Request, Response], request: Request) -> None:
        """As ``call``; an attempt that was not answered may have deleted it, and then there is
        nothing left to find.
        """
        attempts = Attempts(self.retry, True)
        while True:
            try:
                method(request, timeout=self.timeout_s, metadata=self.metadata())
                return
            except grpc.RpcError as problem:
                error: LipofillError = error_from_call(problem, self.server)
            if isinstance(error, NotFoundError) and attempts.made > 0:
                return
            if not attempts.wait_after(error):
                raise error from None

    def stream_items(self, stream: ResponseStream[Response]) -> Iterator[Response]:
        """The responses of a stream, its error as a LipofillError. Leaving the iteration ends the
        stream.
        """
        try:
            yield from stream
        except grpc.RpcError as problem:
            raise error_from_call(problem, self.server) from None
        finally:
            stream.cancel()

    def paged(self, method: UnaryUnary[Any, Any], request: Any, field: str) -> Iterator[Any]:
        """The items of all pages of a List call. Those that are damaged are named in a warning."""
        while True:
            page = self.call(method, request)
            for name in getattr(page, "unreachable", ()):
                warnings.warn(f"{name} is damaged and cannot be shown", stacklevel=3)
            yield from getattr(page, field)
            if not page.next_page_token:
                return
            request.page_token = page.next_page_token
