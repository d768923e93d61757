"""Targets: what a face is to look like, and what it lacks to that."""

from __future__ import annotations

from typing import Mapping, Optional, Sequence, Union

from lipofill.channel import Channel
from lipofill.errors import InvalidArgumentError
from lipofill.operations import Operations
from lipofill.progress import ProgressCallback
from lipofill.retries import with_request_id
from lipofill.v1 import geometry_pb2
from lipofill.v1 import planning_service_pb2 as pb

#: Landmarks by name, in mm in the frame of their scan.
Landmarks = Mapping[str, Union[geometry_pb2.Vector3, Sequence[float]]]

_SIDES = {"left": pb.LEFT, "right": pb.RIGHT}
_MEASURING_TIMEOUT_S = 300.0


def _vectors(landmarks: Optional[Landmarks]) -> Mapping[str, geometry_pb2.Vector3]:
    vectors = {}
    for name, place in (landmarks or {}).items():
        if isinstance(place, geometry_pb2.Vector3):
            vectors[name] = place
        else:
            x, y, z = place
            vectors[name] = geometry_pb2.Vector3(x=x, y=y, z=z)
    return vectors


class Targets:
    """The targets of patients. A target is kept as a scan of the patient, in the frame of the
    face.
    """

    def __init__(self, channel: Channel, operations: Operations) -> None:
        self._channel = channel
        self._operations = operations
        self._stub = channel.planning_stub

    def mirror(
        self,
        scan: str,
        landmarks: Landmarks,
        *,
        healthy_side: str,
        progress: Optional[ProgressCallback] = None,
    ) -> pb.Target:
        """Makes a target of the healthy side, mirrored at the plane of symmetry that is found.

        Parameters
        ----------
        scan : str
            ``patients/{patient}/scans/{scan}``
        landmarks : mapping
            Of that scan, by name, in mm.
        healthy_side : {"left", "right"}
            The subject's own.
        """
        if healthy_side not in _SIDES:
            raise InvalidArgumentError(f"the side '{healthy_side}' is not one of {', '.join(_SIDES)}")
        spec = pb.TargetSpec(
            scan=scan,
            landmarks_mm=_vectors(landmarks),
            mirrored=pb.MirroredSide(healthy_side=_SIDES[healthy_side]),
        )
        return self.make(spec, progress=progress)

    def place(
        self,
        scan: str,
        surface_scan: str,
        *,
        landmarks: Optional[Landmarks] = None,
        surface_landmarks: Optional[Landmarks] = None,
        in_place: bool = False,
        progress: Optional[ProgressCallback] = None,
    ) -> pb.Target:
        """Makes a target of another surface of the same face, registered to it: from landmarks
        where both have three in common, else from the shapes alone; or left where it is.

        Raises
        ------
        FailedPreconditionError
            It cannot be placed with confidence; the message has the figures.
        """
        surface = pb.FaceSurface(
            scan=surface_scan,
            landmarks_mm=_vectors(surface_landmarks),
            placement=pb.FaceSurface.IN_PLACE if in_place else pb.FaceSurface.REGISTERED,
        )
        spec = pb.TargetSpec(scan=scan, landmarks_mm=_vectors(landmarks), surface=surface)
        return self.make(spec, progress=progress)

    def make(self, spec: pb.TargetSpec, *, progress: Optional[ProgressCallback] = None) -> pb.Target:
        """Makes a target and waits for it. An interruption (Ctrl-C, an exception of `progress`)
        cancels the making too.
        """
        patient = "/".join(spec.scan.split("/")[:2])
        request = with_request_id(pb.MakeTargetRequest(parent=patient, spec=spec))
        return self._operations.carry_out(
            lambda: self._channel.call(self._stub.MakeTarget, request),
            pb.Target(),
            doing="made the target",
            progress=progress,
        )

    def deficit(
        self,
        scan: str,
        target_scan: str,
        *,
        landmarks: Optional[Landmarks] = None,
        rim_mm: Optional[float] = None,
        figures_only: bool = False,
    ) -> pb.Deficit:
        """What a face lacks to its target: in all and by region of the face, and the signed
        distance of every vertex of the scan [mm], negative where something is missing, not a number
        where it is not compared.
        """
        request = pb.MeasureDeficitRequest(
            scan=scan,
            landmarks_mm=_vectors(landmarks),
            target_scan=target_scan,
            rim_mm=rim_mm,
            figures_only=figures_only,
        )
        return self._channel.call(self._stub.MeasureDeficit, request, timeout_s=_MEASURING_TIMEOUT_S)
