"""Meshes and frames as they come from a simulation."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Iterator, List, Optional

import numpy.typing as npt

from lipofill.arrays import Array, ArrayAssembler
from lipofill.v1 import frame_service_pb2 as pb


@dataclass(frozen=True)
class Meshes:
    """The meshes of a simulation or a model at rest.

    ``meshes["skin.points"]`` is an (n, 3) array in mm, float32 or, for a scan far from the origin,
    float64, ``meshes["skin.cells"]`` the (m, 4) uint32 indices into it.

    Attributes
    ----------
    topology_hash : str
        Of what the meshes are; who has them need not get them again.
    arrays : dict of str to Array
    """

    topology_hash: str
    arrays: Dict[str, Array] = field(repr=False)

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        return self.arrays[name].values

    def __contains__(self, name: object) -> bool:
        return name in self.arrays

    def names(self) -> List[str]:
        """Of the meshes: "skin", "scan", "film/<film>", "tissue"."""
        return list(dict.fromkeys(array.mesh for array in self.arrays.values()))


@dataclass(frozen=True)
class Frame:
    """The fields of one step. ``frame["skin.displacement"]`` is an (n, 3) float32 array in mm.

    Attributes
    ----------
    epoch, sequence : int
        The step is `sequence`; `epoch` changes where the daemon went back to an earlier state.
    time_s : float
        Simulated.
    skipped_frames : int
        Left out before this one because the viewer was slow.
    end : bool
        The last frame of the simulation.
    preview : bool
        The settled shape as a coarse model foresees it, not a step.
    fields : dict of str to Array
    meshes : Meshes
        What the fields are on.
    """

    epoch: int
    sequence: int
    time_s: float
    skipped_frames: int
    end: bool
    preview: bool
    fields: Dict[str, Array] = field(repr=False)
    meshes: Meshes = field(repr=False)

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        return self.fields[name].values

    def __contains__(self, name: object) -> bool:
        return name in self.fields

    def __iter__(self) -> Iterator[str]:
        return iter(self.fields)

    def moved_points(self, mesh: str) -> npt.NDArray[Any]:
        """Where the points of a mesh are now [mm], (n, 3): the points at rest plus
        ``"<mesh>.displacement"``.
        """
        points: npt.NDArray[Any] = self.meshes[f"{mesh}.points"] + self[f"{mesh}.displacement"]
        return points


_NO_MESHES = Meshes("", {})


class StreamAssembler:
    """Puts the messages of one stream of FrameService.Watch together."""

    def __init__(self, meshes: Optional[Meshes] = None) -> None:
        self.meshes = meshes or _NO_MESHES
        self._mesh_arrays = ArrayAssembler()
        self._fields = ArrayAssembler()

    def add(self, response: pb.WatchResponse) -> Optional[Frame]:
        """A frame once its last slice has come."""
        kind = response.WhichOneof("message")
        if kind == "mesh":
            self._add_mesh(response.mesh)
        return self._add_frame(response.frame) if kind == "frame" else None

    def _add_mesh(self, piece: pb.MeshSlice) -> None:
        for array in piece.arrays:
            self._mesh_arrays.add(array)
        if piece.last:
            self.meshes = Meshes(piece.topology_hash, self._mesh_arrays.take())

    def _add_frame(self, piece: pb.FrameSlice) -> Optional[Frame]:
        for array in piece.fields:
            self._fields.add(array)
        if not piece.last:
            return None
        return Frame(
            epoch=piece.epoch,
            sequence=piece.sequence,
            time_s=piece.time_s,
            skipped_frames=piece.skipped_frames,
            end=piece.end,
            preview=piece.preview,
            fields=self._fields.take(),
            meshes=self.meshes,
        )


def meshes_from_slices(slices: Iterator[pb.MeshSlice]) -> Meshes:
    """The meshes that a stream of slices makes."""
    assembler, topology_hash = ArrayAssembler(), ""
    for piece in slices:
        topology_hash = piece.topology_hash
        for array in piece.arrays:
            assembler.add(array)
    return Meshes(topology_hash, assembler.take())
