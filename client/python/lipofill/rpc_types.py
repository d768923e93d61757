"""The types of the callables that gRPC makes of the methods of a service; gRPC 1.51 itself is
untyped.
"""

from __future__ import annotations

from typing import Iterator, Optional, Protocol, Sequence, Tuple, TypeVar

Request = TypeVar("Request", contravariant=True)
Response = TypeVar("Response", covariant=True)
Metadata = Sequence[Tuple[str, str]]


class UnaryUnary(Protocol[Request, Response]):
    """One request, one response."""

    def __call__(
        self, request: Request, timeout: Optional[float] = None, metadata: Optional[Metadata] = None
    ) -> Response:
        ...


class ResponseStream(Protocol[Response]):
    """Responses as they come; ends with StopIteration or grpc.RpcError."""

    def __iter__(self) -> Iterator[Response]:
        ...

    def __next__(self) -> Response:
        ...

    def cancel(self) -> bool:
        ...


class UnaryStream(Protocol[Request, Response]):
    """One request, many responses."""

    def __call__(
        self, request: Request, timeout: Optional[float] = None, metadata: Optional[Metadata] = None
    ) -> ResponseStream[Response]:
        ...


class PendingResponse(Protocol[Response]):
    """A response to come."""

    def result(self, timeout: Optional[float] = None) -> Response:
        ...

    def cancel(self) -> bool:
        ...


class StreamUnary(Protocol[Request, Response]):
    """Many requests, one response."""

    def __call__(
        self, request_iterator: Iterator[Request], timeout: Optional[float] = None, metadata: Optional[Metadata] = None
    ) -> Response:
        ...

    def future(
        self, request_iterator: Iterator[Request], timeout: Optional[float] = None, metadata: Optional[Metadata] = None
    ) -> PendingResponse[Response]:
        ...
