"""Landmark files of every kind, as the command line reads them."""

import json
import os
import pathlib

import pytest

import lipofill
from lipofill.landmark_names import understand_name
from lipofill.landmarks import load_landmarks
from lipofill.v1 import model_pb2

CASES = pathlib.Path(os.environ["LIPOFILL_SOURCE"]).parent / "shared/data/reader_cases"


def read(path, unit="mm"):
    region = model_pb2.ScanRegion()
    load_landmarks(str(path), region, scan_unit=unit)
    return {name: (at.x, at.y, at.z) for name, at in region.landmarks_mm.items()}


@pytest.mark.parametrize("name", ["gonion_left", "Left Gonion", "go_l", "GoL", "L-go", "go (L)", "LGo", "gol"])
def test_names_of_common_schemes_are_understood(name):
    assert understand_name(name) == "gonion_left"


@pytest.mark.parametrize("name", ["", "F-1", "tr", "go", "left", "n_left", "sto"])
def test_other_names_are_not(name):
    assert understand_name(name) is None


@pytest.mark.parametrize(
    "text",
    [
        "n,0,85.5,-1\ngo l,62,9,3e1\n",
        'name,x,y,z\r\nn,0,85.5,-1\r\n"go l",62,9,30',
        "\ufefflabel;x_mm;y_mm;z_mm\nn;0;85,5;-1\ngo l;62;9;30\n",
        "x (mm)\ty (mm)\tz (mm)\tLandmark\n0\t85.5\t-1\tn\n62\t9\t30\tgo l\n",
        "1,0,85.5,-1,n\n2,62,9,30,go l",
        "label,l,p,s,defined\nn,0,85.5,-1,1\ngo l,62,9,30,1\nme,,,,0\n",
        "label,r,a,s\nn,0,-85.5,-1\ngo l,-62,-9,30\n",
    ],
)
def test_tables_are_read_however_they_are_written(tmp_path, text):
    (tmp_path / "a.csv").write_text(text, encoding="utf-8", newline="")
    assert read(tmp_path / "a.csv") == {"nasion": (0, 85.5, -1), "gonion_left": (62, 9, 30)}


def test_frames_and_units_of_slicer_are_honoured(tmp_path):
    row = "1,1,2,3,0,0,0,1,1,1,0,nasion,,\n"
    for head, expected in (("# CoordinateSystem = LPS\n", (1, 2, 3)), ("# CoordinateSystem = 0\n", (-1, -2, 3)), ("", (-1, -2, 3))):
        (tmp_path / "a.fcsv").write_text(head + row)
        assert read(tmp_path / "a.fcsv")["nasion"] == expected
    markup = {"coordinateSystem": "RAS", "coordinateUnits": ["cm", "UCUM"]}
    markup["controlPoints"] = [{"label": "n", "position": [1, 2, 3]}, {"label": "me", "positionStatus": "undefined"}]
    (tmp_path / "a.mrk.json").write_text(json.dumps({"markups": [markup]}))
    assert read(tmp_path / "a.mrk.json") == {"nasion": (-10, -20, 30)}


@pytest.mark.parametrize(
    "name, text",
    [
        ("a.csv", ""),
        ("a.csv", "n,0,1\n"),
        ("a.csv", "n,0,nan,1\n"),
        ("a.csv", "n,0,0,1\nnasion,0,0,1\n"),
        ("a.fcsv", "# CoordinateSystem = IJK\n"),
        ("a.pp", "<PickedPoints><point"),
        ("a.mrk.json", '{"markups": [1]}'),
        ("a.mrk.json", '{"markups": 1}'),
        ("a.mrk.json", '{"markups": [{"controlPoints": [{"label": "n", "position": [1, null, 2]}]}]}'),
    ],
)
def test_what_is_wrong_is_refused(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    with pytest.raises(lipofill.InvalidArgumentError):
        read(tmp_path / name)


def test_a_hash_may_be_part_of_a_name(tmp_path):
    folder = tmp_path / "case #3"
    folder.mkdir()
    (folder / "a#1.json").write_text('{"landmarks": {"nasion": [1, 2, 3]}, "before": {"menton": [4, 5, 6]}}')
    assert read(folder / "a#1.json") == {"nasion": (1, 2, 3)}
    assert read(f"{folder}/a#1.json#before") == {"menton": (4, 5, 6)}


@pytest.mark.skipif(not CASES.exists(), reason=f"no files in {CASES}")
@pytest.mark.parametrize(
    "name", ["landmarks.mrk.json", "landmarks.fcsv", "landmarks.pp", "landmarks_in_metres.json"]
)
def test_files_of_other_programs_are_those_of_the_sample_face(name):
    expected = read(CASES / "case #3/faces/half_face.landmarks.json")
    points = read(CASES / name)
    assert points.keys() == expected.keys()
    for landmark, at in points.items():
        assert at == pytest.approx(expected[landmark], abs=1e-9)
