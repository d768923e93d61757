"""Volumes of CT, CBCT and MR: DICOM series, NIfTI, NRRD and MetaImage, and the skin in them.

They are read by the program ``lipofill`` on this machine and go nowhere; only a surface is sent to
the daemon.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from lipofill.errors import InvalidArgumentError, LipofillError

PathLike = Union[str, "os.PathLike[str]"]
_BAD_INPUT = 2


def find_program() -> str:
    """lipofill: $LIPOFILL, or of the build tree that this package is in, or on PATH."""
    built = Path(os.path.abspath(__file__)).parents[2] / "bin" / "lipofill"
    for candidate in (os.environ.get("LIPOFILL"), str(built), shutil.which("lipofill")):
        if candidate and os.access(candidate, os.X_OK):
            return candidate
    raise FileNotFoundError("no lipofill: build or install it, or name it by LIPOFILL")


def _answer_of(arguments: Sequence[str]) -> Dict[str, Any]:
    result = subprocess.run(
        [find_program(), "scan", *arguments, "--json"], capture_output=True, text=True, errors="replace", check=False
    )
    if result.returncode == 0:
        answer: Dict[str, Any] = json.loads(result.stdout)
        return answer
    try:
        message = json.loads(result.stderr[result.stderr.index("{") :])["error"]["message"]
    except (ValueError, KeyError, TypeError):
        message = result.stderr.strip()
    raise (InvalidArgumentError if result.returncode == _BAD_INPUT else LipofillError)(message)


@dataclass(frozen=True)
class DicomSeries:
    """A series of a folder, a zip or a file of DICOM.

    Attributes
    ----------
    number : int
        SeriesNumber; -1 where the headers have none.
    uid : str
        SeriesInstanceUID.
    modality, description : str
        The description holds whatever the scanner's operator wrote.
    images : int
    size : tuple of int
        Columns, rows and slices; empty where the series is no volume.
    spacing_mm : tuple of float
        Between columns, rows and, as their median, slices.
    orientation : str
        "axial", "coronal", "sagittal" or "oblique".
    remarks : tuple of str
        What is odd: a gantry that leans, slices that lie unevenly and the like.
    problem : str
        Why the series is no volume; empty where it is.
    """

    number: int
    uid: str
    modality: str
    description: str
    images: int
    size: Tuple[int, ...] = ()
    spacing_mm: Tuple[float, ...] = ()
    orientation: str = ""
    remarks: Tuple[str, ...] = ()
    problem: str = ""


@dataclass(frozen=True)
class Skin:
    """A surface out of a volume, in a file of its own.

    Attributes
    ----------
    file : Path
        What ``Connection.scans`` uploads.
    vertices, triangles, components : int
    bounds_mm : tuple of float
        Least and most x, y and z.
    frame : str
        "LPS" (x to the left, y to the back, z up) or "the file's own".
    isovalue : float
    remarks : tuple of str
        What was odd in the volume, and how it was understood.
    """

    file: Path
    vertices: int
    triangles: int
    components: int
    bounds_mm: Tuple[float, ...]
    frame: str
    isovalue: float
    remarks: Tuple[str, ...]


def list_series(source: PathLike) -> List[DicomSeries]:
    """The DICOM series in a folder, a zip or a file.

    Raises InvalidArgumentError for a source that cannot be read.
    """
    found = []
    for series in _answer_of(["series", os.fspath(source)])["series"]:
        found.append(DicomSeries(**{key: tuple(v) if isinstance(v, list) else v for key, v in series.items()}))
    return found


def convert_surface(surface: PathLike, out: PathLike, *, unit: str = "mm") -> Tuple[str, ...]:
    """A .glb or .gltf as a .ply in mm, with the colours of its vertices.

    The format has metres, and so is a surface smaller than 5 units understood; a larger one is in
    `unit`, "mm", "cm" or "m".

    Returns
    -------
    tuple of str
        What was passed over, and how the unit was understood.

    Raises InvalidArgumentError for what cannot be read.
    """
    answer = _answer_of(["convert", os.fspath(surface), "--out", os.fspath(out), "--unit", unit])
    return tuple(answer["remarks"])


def extract_skin(
    volume: PathLike,
    out: PathLike,
    *,
    isovalue: float = -300.0,
    labels: Sequence[Union[int, str]] = (),
    series: Optional[Union[int, str]] = None,
    all_components: bool = False,
    smooth: int = 0,
    triangles: Optional[int] = None,
    bridge_gaps: bool = False,
) -> Skin:
    """The surface where a volume takes a value, -300 HU being the skin in a CT and 250 the bone.

    Parameters
    ----------
    volume : path
        .mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz or .hdr, or a folder, a zip or a file of DICOM.
    out : path
        .obj, .ply or .stl.
    labels : sequence of int or str
        Of a label map or DICOM-SEG: the surface around voxels with these numbers or names, or of
        these tissues ("skin", "fat", "muscle", "bone"), or of "all"; the isovalue is not used then.
    series : int or str, optional
        Of DICOM: SeriesNumber or SeriesInstanceUID; default: the largest axial CT.
    all_components : bool
        Every piece, as bone wants it, and not only the largest.
    smooth : int
        Iterations of windowed-sinc smoothing.
    triangles : int, optional
        Thin out to about as many.
    bridge_gaps : bool
        Of DICOM: cross places where slices are missing in a straight line.

    Raises InvalidArgumentError with what is wrong and the next step.
    """
    arguments = ["extract", os.fspath(volume), "--out", os.fspath(out), f"--isovalue={isovalue!r}", f"--smooth={smooth}"]
    arguments += ["--series", str(series)] if series is not None else []
    arguments += [f"--label={label}" for label in labels]
    arguments += ["--triangles", str(triangles)] if triangles is not None else []
    arguments += ["--all"] if all_components else []
    arguments += ["--bridge-gaps"] if bridge_gaps else []
    answer = _answer_of(arguments)
    return Skin(
        file=Path(answer["file"]),
        vertices=answer["vertices"],
        triangles=answer["triangles"],
        components=answer["components"],
        bounds_mm=tuple(answer["bounds_mm"]),
        frame=answer["frame"],
        isovalue=answer["isovalue"],
        remarks=tuple(answer["remarks"]),
    )
