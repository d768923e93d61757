"""Settled shapes that are found at once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Iterable

import numpy.typing as npt

from lipofill.arrays import Array, ArrayAssembler
from lipofill.v1 import simulation_service_pb2 as pb


@dataclass(frozen=True)
class Shape:
    """A settled shape. ``shape["skin.displacement"]`` is an (n, 3) float32 array in mm.

    Attributes
    ----------
    figures : FoundShape
        Its summary, zones and pools; how much of the fat goes in; sensitivities where asked for.
    fields : dict of str to Array
    """

    figures: pb.FoundShape
    fields: Dict[str, Array] = field(repr=False)

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        return self.fields[name].values

    def __contains__(self, name: object) -> bool:
        return name in self.fields


def assemble_shape(responses: Iterable[pb.FindShapeResponse]) -> Shape:
    """Puts the messages of an answer together."""
    figures = pb.FoundShape()
    assembler = ArrayAssembler()
    for response in responses:
        if response.HasField("shape"):
            figures = response.shape
        for piece in response.frame.fields:
            assembler.add(piece)
    return Shape(figures, assembler.take())
