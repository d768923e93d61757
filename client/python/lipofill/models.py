"""Models: built from a scan or a square, immutable."""

from __future__ import annotations

from typing import Iterator, Optional

from lipofill.channel import Channel
from lipofill.frames import Meshes, meshes_from_slices
from lipofill.operations import Operations
from lipofill.progress import ProgressCallback
from lipofill.retries import with_request_id
from lipofill.v1 import model_pb2
from lipofill.v1 import patient_service_pb2 as pb


class Models:
    """The models of patients."""

    def __init__(self, channel: Channel, operations: Operations) -> None:
        self._channel = channel
        self._operations = operations
        self._stub = channel.patient_stub

    def build(
        self, patient: str, spec: model_pb2.ModelSpec, *, progress: Optional[ProgressCallback] = None
    ) -> model_pb2.Model:
        """Builds a model and waits for it. An interruption (Ctrl-C, an exception of `progress`)
        cancels the building too.

        Raises
        ------
        InvalidArgumentError
            With a violation for every field that is out of its bounds.
        """
        request = with_request_id(pb.BuildModelRequest(parent=patient, spec=spec))
        return self._operations.carry_out(
            lambda: self._channel.call(self._stub.BuildModel, request),
            model_pb2.Model(),
            doing="built the model",
            progress=progress,
        )

    def check(self, patient: str, spec: model_pb2.ModelSpec) -> None:
        """Raises what `build` would raise for the spec, as far as it is known without one."""
        self._channel.call(self._stub.BuildModel, pb.BuildModelRequest(parent=patient, spec=spec, validate_only=True))

    def get(self, name: str) -> model_pb2.Model:
        return self._channel.call(self._stub.GetModel, pb.GetModelRequest(name=name))

    def list(self, patient: str) -> Iterator[model_pb2.Model]:
        """Of one patient, by name."""
        return self._channel.paged(self._stub.ListModels, pb.ListModelsRequest(parent=patient), "models")

    def delete(self, name: str) -> None:
        """Keeps the results of its simulations. FailedPreconditionError while one runs on it."""
        self._channel.delete(self._stub.DeleteModel, pb.DeleteModelRequest(name=name))

    def download_meshes(self, name: str) -> Meshes:
        """The model's meshes at rest: ``skin``, ``tissue`` and, where it has one, ``scan``; points
        in mm.
        """
        request = pb.DownloadModelMeshRequest(name=name)
        stream = self._stub.DownloadModelMesh(
            request, timeout=self._channel.timeout_s, metadata=self._channel.metadata()
        )
        return meshes_from_slices(self._channel.stream_items(stream))
