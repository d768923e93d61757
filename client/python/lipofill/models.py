"""Models: built from a scan or a square, immutable."""

from __future__ import annotations

from typing import Iterator, Optional

from lipofill.channel import Channel
from lipofill.errors import LipofillError, NotFoundError, UnavailableError
from lipofill.frames import Meshes, meshes_from_slices
from lipofill.operations import Operations
from lipofill.progress import ProgressCallback
from lipofill.retries import with_request_id
from lipofill.v1 import model_pb2
from lipofill.v1 import operation_service_pb2 as pb_operation
from lipofill.v1 import patient_service_pb2 as pb

_MOST_RESTARTS = 10


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
        for _ in range(_MOST_RESTARTS):
            done = self._build(request, progress)
            if done is not None:
                break
        else:
            raise UnavailableError("the daemon ended again and again while it built the model")
        model = model_pb2.Model()
        if not done.response.Unpack(model):
            raise LipofillError(f"operation {done.name} ended without a model")
        return model

    def check(self, patient: str, spec: model_pb2.ModelSpec) -> None:
        """Raises what `build` would raise for the spec, as far as it is known without one."""
        self._channel.call(self._stub.BuildModel, pb.BuildModelRequest(parent=patient, spec=spec, validate_only=True))

    def _build(
        self, request: pb.BuildModelRequest, progress: Optional[ProgressCallback]
    ) -> Optional[pb_operation.Operation]:
        """None where the operation went with a daemon that ended: the same request then begins it
        anew, or finds what it made.
        """
        operation = self._channel.call(self._stub.BuildModel, request)
        try:
            return self._operations.wait(operation, progress=progress)
        except NotFoundError as error:
            if error.from_daemon and operation.name in error.message:
                return None
            raise
        except LipofillError:
            raise
        except BaseException:
            self._operations.cancel(operation.name)
            raise

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
