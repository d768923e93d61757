"""google.rpc.Status and its details: those of googleapis-common-protos where that is installed,
else the project's own copy.

Protocol Buffers take a file of one name once a process; a program that uses both must get the same
one.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lipofill.google_rpc.own import error_details_pb2, status_pb2
else:
    try:
        from google.rpc import error_details_pb2, status_pb2
    except ImportError:
        from lipofill.google_rpc.own import error_details_pb2, status_pb2

__all__ = ["error_details_pb2", "status_pb2"]
