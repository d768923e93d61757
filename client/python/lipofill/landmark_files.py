"""Landmark files of other programs: 3D Slicer, MeshLab and tables."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Sequence, Tuple
from xml.etree import ElementTree

from lipofill.errors import InvalidArgumentError

Point = Tuple[float, float, float]
MM_PER = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 0.001}
_IS_RAS = {"LPS": False, "1": False, "RAS": True, "0": True}


@dataclass
class LandmarkList:
    """Landmarks as a file has them, in LPS where it tells its frame, in its unit."""

    points: List[Tuple[str, Point]] = field(default_factory=list)
    mm_per_unit: Optional[float] = None

    def add(self, name: str, values: Sequence[Any], is_ras: bool) -> None:
        try:
            x, y, z = (float(value) for value in values)
        except (TypeError, ValueError):
            raise InvalidArgumentError(f"the landmark {name} is {list(values)!r}, not three numbers") from None
        if not all(math.isfinite(value) for value in (x, y, z)):
            raise InvalidArgumentError(f"the landmark {name} has a coordinate that is not finite")
        self.points.append((name, (-x, -y, z) if is_ras else (x, y, z)))


def _is_ras(system: str) -> bool:
    if system not in _IS_RAS:
        raise InvalidArgumentError(f"the coordinate system is {system!r}, must be LPS or RAS")
    return _IS_RAS[system]


def parse_markups(document: Dict[str, Any]) -> LandmarkList:
    """Markups of 3D Slicer (.mrk.json)."""
    landmarks = LandmarkList()
    for markup in document["markups"]:
        is_ras = _is_ras(str(markup.get("coordinateSystem", "LPS")))
        unit = markup.get("coordinateUnits")
        unit = unit[0] if isinstance(unit, list) and unit else unit
        if unit is not None and unit not in MM_PER:
            raise InvalidArgumentError(f"coordinateUnits is {unit!r}, must be mm, cm, m or um")
        landmarks.mm_per_unit = None if unit is None else MM_PER[unit]
        for point in markup.get("controlPoints", []):
            if point.get("label") and point.get("positionStatus", "defined") == "defined":
                landmarks.add(point["label"], point.get("position") or [], is_ras)
    return landmarks


def parse_fcsv(text: str) -> LandmarkList:
    """Fiducials of 3D Slicer (.fcsv); in RAS where they do not say."""
    landmarks, is_ras, columns = LandmarkList(), True, {"label": 11, "x": 1, "y": 2, "z": 3}
    for line in text.splitlines():
        comment = re.match(r"#\s*(\w+)\s*=\s*(.*)", line)
        if comment and comment.group(1) == "CoordinateSystem":
            is_ras = _is_ras(comment.group(2).strip())
        elif comment and comment.group(1) == "columns":
            columns = {name.strip(): k for k, name in enumerate(comment.group(2).split(","))}
        if line.startswith("#") or not line.strip():
            continue
        row = next(csv.reader([line]))
        row += [""] * (max(columns.values()) + 1 - len(row))
        if row[columns["label"]]:
            landmarks.add(row[columns["label"]], [row[columns[axis]] for axis in "xyz"], is_ras)
    return landmarks


def parse_picked_points(text: str) -> LandmarkList:
    """Points picked in MeshLab (.pp)."""
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise InvalidArgumentError(f"is not XML: {error}") from None
    if root.tag != "PickedPoints":
        raise InvalidArgumentError("has no element PickedPoints")
    landmarks = LandmarkList()
    for point in root.findall("point"):
        if point.get("active") != "0" and point.get("name"):
            landmarks.add(point.get("name", ""), [point.get(axis) for axis in "xyz"], False)
    return landmarks


def _heading(row: Sequence[str], landmarks: LandmarkList) -> Optional[Tuple[int, List[int], int, bool]]:
    """Columns of the name, the coordinates and whether it is placed; whether they are in RAS."""
    name, xyz, placed, is_ras = -1, [-1, -1, -1], -1, False
    for k, cell in enumerate(cell.lower() for cell in row):
        axis = re.fullmatch(r"([xrlyapzs])(?:[_ ]?[(\[]?(mm|cm|m)[)\]]?)?", cell)
        if axis:
            xyz[next(c for c, letters in enumerate(("xrl", "yap", "zs")) if axis.group(1) in letters)] = k
            is_ras = is_ras or axis.group(1) == "r"
            landmarks.mm_per_unit = MM_PER[axis.group(2)] if axis.group(2) else landmarks.mm_per_unit
        name = k if cell in ("name", "label", "landmark", "point") else name
        placed = k if cell == "defined" else placed
    if min(xyz) < 0:
        return None
    if name < 0 and len(row) > 3:
        name = 3 if xyz[0] == 0 else 0
    if name < 0:
        raise InvalidArgumentError("no column has the names of the points")
    return name, xyz, placed, is_ras


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def parse_table(text: str) -> LandmarkList:
    """A table of names and coordinates (.csv, .tsv, .txt), with or without a line of headings."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    landmarks = LandmarkList()
    if not lines:
        return landmarks
    separator = next((s for s in "\t;" if s in lines[0]), ",")
    rows = [[cell.strip() for cell in row] for row in csv.reader(lines, delimiter=separator)]
    if separator != ",":
        rows = [[cell.replace(",", ".") if _is_number(cell.replace(",", ".")) else cell for cell in row] for row in rows]
    columns = _heading(rows[0], landmarks)
    if columns is None:
        name = next((k for k, cell in enumerate(rows[0]) if not _is_number(cell)), -1)
        if len(rows[0]) < 4 or name < 0:
            raise InvalidArgumentError("the first line is no name and three coordinates")
        first = name - 3 if name >= 3 else name + 1
        columns = (name, [first, first + 1, first + 2], -1, False)
    else:
        rows = rows[1:]
    name, xyz, placed, is_ras = columns
    for row in rows:
        row += [""] * (max(name, placed, *xyz) + 1 - len(row))
        if row[name] and (placed < 0 or row[placed].lower() not in ("0", "false")):
            landmarks.add(row[name], [row[k] for k in xyz], is_ras)
    return landmarks
