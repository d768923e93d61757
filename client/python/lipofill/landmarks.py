"""Landmark files that plans name beside a scan."""

from __future__ import annotations

import json
import math
import os
from typing import Any, Dict, Tuple

from lipofill.errors import InvalidArgumentError
from lipofill.landmark_files import LandmarkList, parse_fcsv, parse_markups, parse_picked_points, parse_table
from lipofill.landmark_names import understand_name
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
        with open(path, encoding="utf-8-sig") as stream:
            document = json.load(stream)
    except (OSError, ValueError) as error:
        raise InvalidArgumentError(f"{path} is not a JSON file that can be read: {error}") from None
    if not isinstance(document, dict):
        raise InvalidArgumentError(f"{path} is not a JSON object")
    return document


def _split_path(path: str) -> Tuple[str, str]:
    """The file and the object in it. A '#' of a folder, or of a file that there is, names none."""
    file, mark, key = path.rpartition("#")
    if not mark or "/" in key or os.path.isfile(path):
        return path, ""
    return file, key


def _read_list(file: str, ending: str) -> LandmarkList:
    try:
        with open(file, encoding="utf-8-sig") as stream:
            text = stream.read()
    except (OSError, ValueError) as error:
        raise InvalidArgumentError(f"{file} cannot be read: {error}") from None
    if ending == ".fcsv":
        return parse_fcsv(text)
    return parse_picked_points(text) if ending == ".pp" else parse_table(text)


def _put_list(landmarks: LandmarkList, file: str, region: model_pb2.ScanRegion, scale: float) -> None:
    """By the daemon's names, from a list in whatever names."""
    if not landmarks.points:
        raise InvalidArgumentError(f"{file} has no landmark")
    taken: Dict[str, str] = {}
    for given, point in landmarks.points:
        name = understand_name(given) or given
        if name in taken:
            raise InvalidArgumentError(f"{file}: the landmark {name} is there twice, as '{taken[name]}' and '{given}'")
        taken[name] = given
        region.landmarks_mm[name].CopyFrom(_vector(list(point), scale, f"{file}: {given}"))


def load_landmarks(path: str, region: model_pb2.ScanRegion, *, scan_unit: str = "mm") -> None:
    """Puts the landmarks of a file into a region of a scan; axes that the region has stay.

    Names of common schemes ("go_l", "exR", "prn") get the daemon's names.

    Parameters
    ----------
    path : str
        ``FILE.json`` with an object "landmarks" of names to [x, y, z], or ``FILE.json#object``;
        optionally "axes" with "left", "up" and "forward", and "units". Or a file of 3D Slicer
        (``.mrk.json``, ``.fcsv``; RAS is turned to LPS), MeshLab (``.pp``), or a table of names and
        coordinates (``.csv``, ``.tsv``, ``.txt``).
    region : lipofill.v1.ScanRegion
        Changed.
    scan_unit : {"mm", "cm", "m"}
        Of the numbers, where the file does not say.

    Raises
    ------
    InvalidArgumentError
        Naming the file and the entry.
    """
    file, key = _split_path(path)
    ending = os.path.splitext(file)[1].lower()
    try:
        if ending in (".fcsv", ".pp", ".csv", ".tsv", ".txt"):
            landmarks = _read_list(file, ending)
        else:
            document = _read_object(file)
            if key or "markups" not in document:
                _put_own(document, file, key or "landmarks", region, scan_unit)
                return
            landmarks = parse_markups(document)
    except (AttributeError, KeyError, TypeError) as error:
        raise InvalidArgumentError(f"{file} is no landmark file that can be read: {error}") from None
    _put_list(landmarks, file, region, landmarks.mm_per_unit or _MM_PER[scan_unit])


def _put_own(document: Dict[str, Any], file: str, key: str, region: model_pb2.ScanRegion, scan_unit: str) -> None:
    """The project's own JSON, in which the names of the file stay beside those they are understood
    as.
    """
    unit = document.get("units", scan_unit)
    if unit not in _MM_PER:
        raise InvalidArgumentError(f'{file}: units is {unit!r}, not "mm", "cm" or "m"')
    points = document.get(key)
    if not isinstance(points, dict):
        raise InvalidArgumentError(f'{file} has no object "{key}" of landmark names to [x, y, z]')
    for name, value in points.items():
        region.landmarks_mm[name].CopyFrom(_vector(value, _MM_PER[unit], f"{file}: {key}.{name}"))
    for name in points:
        understood = understand_name(name)
        if understood is not None and understood not in points:
            region.landmarks_mm[understood].CopyFrom(region.landmarks_mm[name])
    if "axes" not in document or region.HasField("axes"):
        return
    for name in ("left", "up", "forward"):
        axis = document["axes"].get(name) if isinstance(document["axes"], dict) else None
        getattr(region.axes, name).CopyFrom(_vector(axis, 1.0, f"{file}: axes.{name}"))
