"""Volumes, read by the real lipofill: a ball of tissue in NRRD and in DICOM of the test's own."""

import pathlib
import struct
import zipfile
from typing import List, Tuple, Union

import numpy
import pytest

import lipofill

SIZE = (20, 24, 28)
RADIUS_MM = 8.0
CENTRE = (10.0, 12.0, 14.0)


def ball() -> "numpy.ndarray":
    """0 HU within the ball, -1000 HU around it; axes z, y, x."""
    z, y, x = numpy.indices(SIZE[::-1])
    distance = numpy.sqrt((x - CENTRE[0]) ** 2 + (y - CENTRE[1]) ** 2 + (z - CENTRE[2]) ** 2)
    return numpy.clip(-500 + 250 * (RADIUS_MM - distance), -1000, 0).astype("<i2")


def write_nrrd(file: pathlib.Path) -> None:
    header = (
        "NRRD0005\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 20 24 28\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nendian: little\nencoding: raw\n\n"
    )
    file.write_bytes(header.encode() + ball().tobytes())


def element(group: int, number: int, kind: str, value: Union[str, int, bytes]) -> bytes:
    """One element of explicit little endian."""
    data = struct.pack("<H", value) if isinstance(value, int) else value.encode() if isinstance(value, str) else value
    if len(data) % 2 == 1:
        data += b"\0" if kind == "UI" else b" "
    head = struct.pack("<HH", group, number) + kind.encode()
    if kind in ("OB", "OW"):
        return head + struct.pack("<HI", 0, len(data)) + data
    return head + struct.pack("<H", len(data)) + data


def slice_bytes(k: int) -> bytes:
    """Slice k of the ball as a DICOM file."""
    elements: List[Tuple[int, int, str, Union[str, int, bytes]]] = [
        (0x0008, 0x0016, "UI", "1.2.840.10008.5.1.4.1.1.2"),
        (0x0008, 0x0018, "UI", f"1.2.3.{k + 1}"),
        (0x0008, 0x0060, "CS", "CT"),
        (0x0008, 0x103E, "LO", "ball"),
        (0x0010, 0x0010, "PN", "JANE^SECRET"),
        (0x0020, 0x000E, "UI", "1.2.3"),
        (0x0020, 0x0011, "IS", "4"),
        (0x0020, 0x0032, "DS", f"0\\0\\{k}"),
        (0x0020, 0x0037, "DS", "1\\0\\0\\0\\1\\0"),
        (0x0028, 0x0002, "US", 1),
        (0x0028, 0x0004, "CS", "MONOCHROME2"),
        (0x0028, 0x0010, "US", SIZE[1]),
        (0x0028, 0x0011, "US", SIZE[0]),
        (0x0028, 0x0030, "DS", "1\\1"),
        (0x0028, 0x0100, "US", 16),
        (0x0028, 0x0101, "US", 16),
        (0x0028, 0x0102, "US", 15),
        (0x0028, 0x0103, "US", 1),
        (0x0028, 0x1052, "DS", "0"),
        (0x0028, 0x1053, "DS", "1"),
        (0x7FE0, 0x0010, "OW", ball()[k].tobytes()),
    ]
    meta = element(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1")
    meta = element(0x0002, 0x0000, "UL", struct.pack("<I", len(meta))) + meta
    return b"\0" * 128 + b"DICM" + meta + b"".join(element(*each) for each in elements)


def write_series(folder: pathlib.Path) -> None:
    folder.mkdir()
    for k in range(SIZE[2]):
        (folder / f"{(k * 5) % SIZE[2]:03d}").write_bytes(slice_bytes(k))


def expect_ball(skin: lipofill.Skin) -> None:
    assert skin.file.stat().st_size > 1000
    assert skin.frame == "LPS" and skin.components == 1
    for axis in range(3):
        least, most = skin.bounds_mm[2 * axis : 2 * axis + 2]
        assert least == pytest.approx(CENTRE[axis] - RADIUS_MM, abs=0.05)
        assert most == pytest.approx(CENTRE[axis] + RADIUS_MM, abs=0.05)


def test_a_volume(tmp_path: pathlib.Path) -> None:
    write_nrrd(tmp_path / "ball.nrrd")
    expect_ball(lipofill.extract_skin(tmp_path / "ball.nrrd", tmp_path / "skin.ply", isovalue=-500))


def test_a_label(tmp_path: pathlib.Path) -> None:
    # Voxels of -500 HU and more are half a voxel's step from the ball.
    write_nrrd(tmp_path / "map.nrrd")
    header, _ = (tmp_path / "map.nrrd").read_bytes().split(b"\n\n", 1)
    (tmp_path / "map.nrrd").write_bytes(header + b"\n\n" + numpy.where(ball() > -500, 7, 0).astype("<i2").tobytes())
    skin = lipofill.extract_skin(tmp_path / "map.nrrd", tmp_path / "skin.ply", labels=[7])
    assert skin.bounds_mm[0] == pytest.approx(CENTRE[0] - RADIUS_MM, abs=1.0)
    with pytest.raises(lipofill.InvalidArgumentError, match="no voxel of label 3; its labels are 0, 7"):
        lipofill.extract_skin(tmp_path / "map.nrrd", tmp_path / "skin.ply", labels=[3])


def test_a_series(tmp_path: pathlib.Path) -> None:
    write_series(tmp_path / "ct")
    (series,) = lipofill.list_series(tmp_path / "ct")
    assert (series.number, series.modality, series.description, series.images) == (4, "CT", "ball", SIZE[2])
    assert series.size == SIZE and series.orientation == "axial" and not series.problem
    skin = lipofill.extract_skin(tmp_path / "ct", tmp_path / "skin.stl", isovalue=-500, series=4)
    expect_ball(skin)
    assert "SECRET" not in str(skin) + str(series)
    with zipfile.ZipFile(tmp_path / "ct.zip", "w", zipfile.ZIP_DEFLATED) as packed:
        for file in (tmp_path / "ct").iterdir():
            packed.write(file, file.name)
    expect_ball(lipofill.extract_skin(tmp_path / "ct.zip", tmp_path / "b.ply", isovalue=-500))


def test_bad_input_says_what_to_do(tmp_path: pathlib.Path) -> None:
    write_nrrd(tmp_path / "ball.nrrd")
    with pytest.raises(lipofill.InvalidArgumentError, match="its values go from -1000 to 0; try --isovalue"):
        lipofill.extract_skin(tmp_path / "ball.nrrd", tmp_path / "skin.ply", isovalue=700)
    (tmp_path / "none").mkdir()
    with pytest.raises(lipofill.InvalidArgumentError, match="holds no DICOM image"):
        lipofill.extract_skin(tmp_path / "none", tmp_path / "skin.ply")
