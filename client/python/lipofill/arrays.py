"""Arrays of meshes and frames: the bytes of the messages, seen through NumPy."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Dict, List

import numpy as np
import numpy.typing as npt

from lipofill.errors import DataLossError
from lipofill.v1 import frame_service_pb2 as pb

_DTYPES = {pb.FLOAT32: "<f4", pb.FLOAT64: "<f8", pb.UINT32: "<u4", pb.UINT8: "u1", pb.UINT16: "<u2"}
_LOCATIONS = {pb.MESH: "mesh", pb.POINT: "point", pb.CELL: "cell"}
_MAX_BYTES = 4 << 30


@dataclass(frozen=True)
class Array:
    """One whole array of a mesh or a frame.

    Attributes
    ----------
    name : str
        ``"<mesh>.<field>"``, for example ``"skin.displacement"`` or ``"film/deep.pressure"``.
    unit : str
        ``"mm"``, ``"Pa"``, ``"mm/s"`` or empty.
    location : str
        ``"point"`` or ``"cell"`` for fields, ``"mesh"`` for the mesh itself: ``points`` (n, 3) and
        ``cells`` (n, 3, 4 or 8).
    values : ndarray, read-only
        float32, uint32 or uint8, and float64 for points far from the origin, in the shape the
        daemon states. Over the bytes of the message,
        without a copy, where the array came in one piece (up to 1 MiB) and not as codes.
    max_error : float
        How far a value may be from what the daemon computed, in `unit`: 0 but for arrays that came
        as 16-bit codes.
    """

    name: str
    unit: str
    location: str
    values: npt.NDArray[Any]
    max_error: float = 0.0

    @property
    def mesh(self) -> str:
        return self.name.rpartition(".")[0]

    @property
    def field(self) -> str:
        return self.name.rpartition(".")[2]


class _Growing:
    """An array between its first slice and its last. Holds no more than what has come."""

    def __init__(self, first: pb.ArraySlice) -> None:
        if first.type not in _DTYPES:
            raise DataLossError(f"array '{first.name}' has an unknown type {first.type}")
        if first.location not in _LOCATIONS:
            raise DataLossError(f"array '{first.name}' has an unknown location {first.location}")
        self.name, self.unit, self.max_error = first.name, first.unit, first.max_error
        self.location = _LOCATIONS[first.location]
        self.dtype = np.dtype(_DTYPES[first.type])
        self.shape = tuple(first.shape)
        self.size_bytes = math.prod(self.shape) * self.dtype.itemsize
        if not self.shape or self.size_bytes > _MAX_BYTES:
            raise DataLossError(f"array '{self.name}' has no usable shape {self.shape}")
        self.is_coded = first.type == pb.UINT16
        self.box = np.array([first.box_min, first.box_max]) if self.is_coded else np.empty((2, 0))
        components = self.shape[1] if len(self.shape) > 1 else 1
        if self.is_coded and (self.box.shape != (2, components) or not np.isfinite(self.box).all()):
            raise DataLossError(f"array '{self.name}' has codes without a usable box")
        self.pieces: List[bytes] = []
        self.received = 0

    def add(self, piece: pb.ArraySlice) -> None:
        if piece.offset_bytes != self.received:
            raise DataLossError(
                f"array '{self.name}': a slice at byte {piece.offset_bytes} came where byte {self.received} was due"
            )
        data = piece.data
        self.received += len(data)
        if self.received > self.size_bytes:
            raise DataLossError(f"array '{self.name}' is longer than its shape")
        self.pieces.append(data)

    def whole(self) -> Array:
        if self.received != self.size_bytes:
            raise DataLossError(f"array '{self.name}' ended after {self.received} of {self.size_bytes} bytes")
        data = self.pieces[0] if len(self.pieces) == 1 else b"".join(self.pieces)
        values: npt.NDArray[Any] = np.frombuffer(data, self.dtype).reshape(self.shape)
        if self.is_coded:
            values = self._decoded(values)
        return Array(self.name, self.unit, self.location, values, self.max_error)

    def _decoded(self, codes: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
        """value = box_min + code / 65535 * (box_max - box_min), to float32; see ArraySlice in the
        wire schema.
        """
        low, high = self.box if codes.ndim > 1 else self.box[:, 0]
        values: npt.NDArray[np.float32] = (low + codes / 65535.0 * (high - low)).astype(np.float32)
        values.flags.writeable = False
        return values


class ArrayAssembler:
    """Puts slices together to whole arrays.

    Raises
    ------
    DataLossError
        For a slice that does not follow the one before it, or goes beyond its shape, and for bytes
        that are missing.
    """

    def __init__(self) -> None:
        self._arrays: Dict[str, _Growing] = {}
        self._last = ""

    def add(self, piece: pb.ArraySlice) -> None:
        if piece.name not in self._arrays:
            self._arrays[piece.name] = _Growing(piece)
        elif piece.name != self._last:
            raise DataLossError(f"array '{piece.name}' came twice")
        self._last = piece.name
        self._arrays[piece.name].add(piece)

    def take(self) -> Dict[str, Array]:
        """The arrays by name, in the order they came, and starts anew."""
        growing, self._arrays, self._last = self._arrays, {}, ""
        return {name: each.whole() for name, each in growing.items()}
