"""Scans: sent in chunks, hashed, taken up where a connection broke."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import Iterator, Optional, Union

import grpc

from lipofill.channel import Channel
from lipofill.errors import InvalidArgumentError, LipofillError, error_from_call
from lipofill.frames import Meshes, meshes_from_slices
from lipofill.progress import ProgressCallback, report
from lipofill.retries import Attempts
from lipofill.v1 import patient_service_pb2 as pb
from lipofill.v1 import plan_pb2

CHUNK_BYTES = 1 << 20
_FORMATS = {".obj": pb.OBJ, ".ply": pb.PLY, ".stl": pb.STL}
UNITS = {"mm": plan_pb2.MILLIMETRE, "cm": plan_pb2.CENTIMETRE, "m": plan_pb2.METRE}


def unit_of(unit: str) -> plan_pb2.ScanUnit:
    """The unit of a scan: "mm", "cm" or "m"."""
    if unit not in UNITS:
        raise InvalidArgumentError(f"the unit '{unit}' is not one of {', '.join(UNITS)}")
    return UNITS[unit]


def sha256_of(file: Path) -> str:
    """SHA-256 of a file, lower-case hex."""
    digest = hashlib.sha256()
    with open(file, "rb") as stream:
        for chunk in iter(lambda: stream.read(CHUNK_BYTES), b""):
            digest.update(chunk)
    return digest.hexdigest()


class _Chunks:
    """What the daemon does not have yet. gRPC takes the chunks on a thread of its own; what fails
    there is kept in `problem`.
    """

    def __init__(self, file: Path, scan: pb.Scan, progress: Optional[ProgressCallback]) -> None:
        self._file = file
        self._scan = scan
        self._progress = progress
        self.problem: Optional[BaseException] = None

    def __iter__(self) -> Iterator[pb.UploadScanRequest]:
        try:
            yield from self._read()
        except GeneratorExit:
            raise
        except BaseException as problem:
            self.problem = problem

    def _read(self) -> Iterator[pb.UploadScanRequest]:
        size, offset, name = self._scan.size_bytes, self._scan.received_bytes, self._scan.name
        with open(self._file, "rb") as stream:
            stream.seek(offset)
            # Also where all bytes are there already: the daemon may have ended before it could
            # complete the scan.
            while (data := stream.read(CHUNK_BYTES)) or name:
                yield pb.UploadScanRequest(name=name, offset=offset, data=data)
                offset, name = offset + len(data), ""
                report(
                    self._progress, "upload", offset / max(size, 1), f"{offset} of {size} bytes of {self._file.name}"
                )


class Scans:
    """The scans of patients."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._stub = channel.patient_stub

    def upload(
        self,
        patient: str,
        file: Union[str, os.PathLike[str]],
        *,
        unit: str = "mm",
        progress: Optional[ProgressCallback] = None,
    ) -> pb.Scan:
        """Sends a scan in chunks of at most 1 MiB. Bytes that the daemon has of an earlier upload
        are not sent again.

        Parameters
        ----------
        patient : str
            ``patients/{patient}``
        file : path
            OBJ, PLY or STL, of at most 256 MiB.
        unit : {"mm", "cm", "m"}
            Of the coordinates in the file.

        Returns
        -------
        lipofill.v1.Scan
            Complete, with what was found in the file.

        Raises
        ------
        InvalidArgumentError
            Not a format of a scan, or not a surface that can be read.
        OSError
            The file cannot be read.
        """
        path = Path(file)
        if path.suffix.lower() in (".glb", ".gltf"):
            raise InvalidArgumentError(f"scan file {path}: glTF is converted first: lipofill.convert_surface")
        if path.suffix.lower() not in _FORMATS:
            raise InvalidArgumentError(f"scan file {path}: '{path.suffix}' is not one of {', '.join(_FORMATS)}")
        scan = self.announce(patient, path, unit=unit)
        attempts = Attempts(self._channel.retry, True)
        while not scan.complete:
            try:
                return self._send(_Chunks(path, scan, progress))
            except grpc.RpcError as problem:
                error: LipofillError = error_from_call(problem, self._channel.server)
            if not attempts.wait_after(error):
                raise error from None
            scan = self.get(scan.name)
        return scan

    def _send(self, chunks: _Chunks) -> pb.Scan:
        """Sends one stream to its end; an exception of the callback, or in this thread, ends it."""
        call = self._stub.UploadScan.future(iter(chunks), metadata=self._channel.metadata())
        try:
            scan = call.result()
        except grpc.RpcError:
            if chunks.problem is None:
                raise
        finally:
            call.cancel()
        if chunks.problem is not None:
            raise chunks.problem
        return scan

    def announce(self, patient: str, file: Union[str, os.PathLike[str]], *, unit: str = "mm") -> pb.Scan:
        """Tells of a scan to come. The request id is made of the content: a repeated upload finds
        what the first one began.
        """
        path = Path(file)
        digest, scan_format = sha256_of(path), _FORMATS[path.suffix.lower()]
        identity = hashlib.sha256(f"{patient} {digest} {scan_format} {unit}".encode()).hexdigest()
        request = pb.CreateScanRequest(
            request_id=identity,
            parent=patient,
            format=scan_format,
            unit=unit_of(unit),
            size_bytes=path.stat().st_size,
            sha256=digest,
        )
        return self._channel.call(self._stub.CreateScan, request)

    def get(self, name: str) -> pb.Scan:
        return self._channel.call(self._stub.GetScan, pb.GetScanRequest(name=name))

    def list(self, patient: str) -> Iterator[pb.Scan]:
        """Of one patient, by name."""
        return self._channel.paged(self._stub.ListScans, pb.ListScansRequest(parent=patient), "scans")

    def download_mesh(self, name: str) -> Meshes:
        """The surface of a complete scan as it was read: ``scan.points`` in mm, ``scan.cells``, and
        where its vertices have colours ``scan.colour``, red, green and blue from 0 to 255.
        """
        request = pb.DownloadScanMeshRequest(name=name)
        stream = self._stub.DownloadScanMesh(
            request, timeout=self._channel.timeout_s, metadata=self._channel.metadata()
        )
        return meshes_from_slices(self._channel.stream_items(stream))

    def delete(self, name: str) -> None:
        """FailedPreconditionError while a model was built from it."""
        self._channel.delete(self._stub.DeleteScan, pb.DeleteScanRequest(name=name))
