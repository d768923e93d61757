"""Landmark files: the JSON that plans name beside a scan."""

from __future__ import annotations

import json
import math
from typing import Any, Dict

from lipofill.errors import InvalidArgumentError
from lipofill.v1 import geometry_pb2, model_pb2

_MM_PER = {"mm": 1.0, "cm": 10.0, "m": 1000.0}


def _vector(value: Any, scale: float, where: str) -> geometry_pb2.Vector3:
    if not isinstance(value, list) or len(value) != 3:
        raise InvalidArgumentError(f"{where} is not [x, y, z]")
    for index, number in enumerate(value):
        if isinstance(number, bool) or not isinstance(number, (int, float)) or not math.isfinite(number):
            raise InvalidArgumentError(f"{where}[{index}] is not a finite number")
    x, y, z = (scale * number for number in value)
    return geometry_pb2.Vector3(x=x, y=y, z=z)


def _read_object(path: str) -> Dict[str, Any]:
    try:
        with open(path, encoding="utf-8") as stream:
            document = json.load(stream)
    except (OSError, ValueError) as error:
        raise InvalidArgumentError(f"{path} is not a JSON file that can be read: {error}") from None
    if not isinstance(document, dict):
        raise InvalidArgumentError(f"{path} is not a JSON object")
    return document


def load_landmarks(path: str, region: model_pb2.ScanRegion, *, scan_unit: str = "mm") -> None:
    """Puts the landmarks of a file into a region of a scan; axes that the region has stay.

    Parameters
    ----------
    path : str
        ``FILE.json`` with an object "landmarks" of names to [x, y, z], or ``FILE.json#object``;
        optionally "axes" with "left", "up" and "forward", and "units".
    region : lipofill.v1.ScanRegion
        Changed.
    scan_unit : {"mm", "cm", "m"}
        Of the numbers, where the file does not say.

    Raises
    ------
    InvalidArgumentError
        Naming the file and the entry.
    """
    file, _, key = path.partition("#")
    key = key or "landmarks"
    document = _read_object(file)
    unit = document.get("units", scan_unit)
    if unit not in _MM_PER:
        raise InvalidArgumentError(f'{file}: units is {unit!r}, not "mm", "cm" or "m"')
    points = document.get(key)
    if not isinstance(points, dict):
        raise InvalidArgumentError(f'{file} has no object "{key}" of landmark names to [x, y, z]')
    for name, value in points.items():
        region.landmarks_mm[name].CopyFrom(_vector(value, _MM_PER[unit], f"{file}: {key}.{name}"))
    if "axes" not in document or region.HasField("axes"):
        return
    for name in ("left", "up", "forward"):
        axis = document["axes"].get(name) if isinstance(document["axes"], dict) else None
        getattr(region.axes, name).CopyFrom(_vector(axis, 1.0, f"{file}: axes.{name}"))
