"""Scenes of a real run: Khronos' validator finds nothing wrong with a GLB, and VTK reads it where
the skin is.
"""

import json
import os
import pathlib
import shutil
import subprocess
from typing import Any, Dict

import numpy
import pytest

import lipofill
from conftest import PLANS, SOURCE

VALIDATOR = SOURCE / "build" / "api-tools" / "node_modules" / "gltf-validator"
VALIDATE = """
const validator = require(process.argv[1]);
const bytes = new Uint8Array(require("fs").readFileSync(process.argv[2]));
validator.validateBytes(bytes).then((report) => console.log(JSON.stringify(report)));
"""


def run(*arguments: Any) -> Dict[str, Any]:
    command = [os.environ["LIPOFILL"], *map(str, arguments), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=250)
    assert done.returncode == 0, (command, done.stdout, done.stderr)
    answer: Dict[str, Any] = json.loads(done.stdout)
    return answer


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    folder = tmp_path_factory.mktemp("scene") / "result"
    plan = json.loads((PLANS / "jaw_angle.json").read_text())
    for part in ("file", "landmarks_file"):
        plan["scan"][part] = str(PLANS / plan["scan"][part])
    plan["simulation"]["time"]["goal"] = "SETTLED_SHAPE"
    (folder.parent / "plan.json").write_text(json.dumps(plan))
    run("run", folder.parent / "plan.json", "--out", folder, "--spawn")
    return folder


@pytest.mark.skipif(not VALIDATOR.exists() or shutil.which("node") is None, reason="gltf-validator is not installed")
@pytest.mark.parametrize("colour", ["lift", "pressure"])
def test_a_glb_is_what_khronos_says(result: pathlib.Path, tmp_path: pathlib.Path, colour: str) -> None:
    made = run("scene", result, "--out", tmp_path / "face.glb", "--colour", colour, "--play-s", 4)
    command = ["node", "-e", VALIDATE, str(VALIDATOR), str(tmp_path / "face.glb")]
    report = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    assert report["issues"]["numErrors"] == 0 and report["issues"]["numWarnings"] == 0, report["issues"]
    assert report["info"]["hasMorphTargets"] and report["info"]["animationCount"] == (1 if made["stills"] > 1 else 0)
    assert report["info"]["totalTriangleCount"] == made["triangles"]


def test_a_glb_becomes_a_scan_again(result: pathlib.Path, tmp_path: pathlib.Path) -> None:
    made = run("scene", result, "--out", tmp_path / "face.glb")
    scan = run("scan", "convert", tmp_path / "face.glb", "--out", tmp_path / "face.ply")
    assert scan["triangles"] == made["triangles"] and scan["coloured"] and scan["mm_per_unit"] == 1000
    assert "morph targets are passed over" in " ".join(scan["remarks"])
    vtk = pytest.importorskip("vtk")
    read = vtk.vtkPLYReader()
    read.SetFileName(str(tmp_path / "face.ply"))
    read.Update()
    original = vtk.vtkOBJReader()
    original.SetFileName(str(SOURCE / "client" / "examples" / "faces" / "half_face.obj"))
    original.Update()
    # The plan's up is y, which glTF has too: the face lies where it lay.
    assert read.GetOutput().GetBounds() == pytest.approx(original.GetOutput().GetBounds(), abs=1e-3)
    assert read.GetOutput().GetPointData().GetScalars().GetName() == "RGB"


def test_a_glb_keeps_the_colours_of_the_scan(result: pathlib.Path, tmp_path: pathlib.Path) -> None:
    face = (SOURCE / "client" / "examples" / "faces" / "half_face.obj").read_text().splitlines()
    coloured = [line + " 1 0 0" if line.startswith("v ") else line for line in face]
    (tmp_path / "face.obj").write_text("\n".join(coloured))
    run("scene", result, "--out", tmp_path / "face.glb", "--scan", tmp_path / "face.obj")
    run("scan", "convert", tmp_path / "face.glb", "--out", tmp_path / "face.ply")
    vtk = pytest.importorskip("vtk")
    reader = vtk.vtkPLYReader()
    reader.SetFileName(str(tmp_path / "face.ply"))
    reader.Update()
    colours = reader.GetOutput().GetPointData().GetScalars()
    assert {colours.GetTuple3(k) for k in range(colours.GetNumberOfTuples())} == {(255.0, 0.0, 0.0)}


def test_a_scene_of_slicer_names_files_that_are_there(result: pathlib.Path, tmp_path: pathlib.Path) -> None:
    landmarks = SOURCE / "client" / "examples" / "faces" / "half_face.landmarks.json"
    run("scene", result, "--out", tmp_path / "face.mrml", "--landmarks", landmarks)
    scene = (tmp_path / "face.mrml").read_text()
    for name in ("face_before.vtp", "face_planned.vtp", "face_landmarks.mrk.json"):
        assert f'fileName="{name}" coordinateSystem="LPS"' in scene and (tmp_path / name).stat().st_size > 500


def test_tissue_has_layers_strain_and_stress(result: pathlib.Path, tmp_path: pathlib.Path, connection: Any) -> None:
    vtk = pytest.importorskip("vtk")
    with connection.run(lipofill.Plan.load(PLANS / "jaw_angle.json").settle()) as simulated:
        simulated.wait()
        (tmp_path / "tissue.inp").write_bytes(simulated.tissue_deck())
    command = [os.environ["LIPOFILL"], "scene", str(result), "--out", str(tmp_path / "tissue.vtu")]
    subprocess.run([*command, "--deck", str(tmp_path / "tissue.inp")], check=True, capture_output=True)
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "tissue.vtu"))
    reader.Update()
    fields = reader.GetOutput().GetCellData()
    layers = [fields.GetArray("layer").GetValue(k) for k in range(reader.GetOutput().GetNumberOfCells())]
    assert layers.count(1) == layers.count(2) == 40 * 31
    assert 0.95 < fields.GetArray("volume_ratio").GetRange()[0] < fields.GetArray("volume_ratio").GetRange()[1] < 1.05
    assert 0.05 < fields.GetArray("equivalent_strain").GetRange()[1] < 0.5
    assert 1 < fields.GetArray("von_mises_stress_kpa").GetRange()[1] < 100


def test_a_surface_is_converted_from_python(result: pathlib.Path, tmp_path: pathlib.Path) -> None:
    run("scene", result, "--out", tmp_path / "face.glb")
    remarks = lipofill.convert_surface(tmp_path / "face.glb", tmp_path / "face.ply")
    assert any("units of 1000 mm" in remark for remark in remarks) and (tmp_path / "face.ply").stat().st_size > 10_000
    (tmp_path / "bad.glb").write_bytes(b"glTF and no more")
    with pytest.raises(lipofill.InvalidArgumentError, match="bad.glb"):
        lipofill.convert_surface(tmp_path / "bad.glb", tmp_path / "bad.ply")


def test_wrong_input_says_what_to_do(result: pathlib.Path, tmp_path: pathlib.Path) -> None:
    for arguments, message in (
        ((result, "--out", tmp_path / "face.stl"), "must end in .glb, .mrml, .vtu, .mp4 or .webm"),
        ((tmp_path, "--out", tmp_path / "face.glb"), "is not a folder that lipofill run has written"),
        ((result, "--out", tmp_path / "no" / "face.glb"), "cannot write"),
    ):
        command = [os.environ["LIPOFILL"], "scene", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 2 and message in done.stderr, done.stderr


@pytest.mark.skipif(shutil.which("ffprobe") is None, reason="ffmpeg is not installed")
@pytest.mark.parametrize("name, codec", [("rise.mp4", "h264"), ("rise.webm", "vp9")])
def test_a_film_shows_the_rise(result: pathlib.Path, tmp_path: pathlib.Path, name: str, codec: str) -> None:
    run("scene", result, "--out", tmp_path / name, "--play-s", 1)
    show = ["-count_frames", "-show_entries", "stream=codec_name,width,height,nb_read_frames,pix_fmt", "-of", "json"]
    probed = subprocess.run(["ffprobe", "-v", "error", *show, str(tmp_path / name)], capture_output=True, check=True)
    (stream,) = json.loads(probed.stdout)["streams"]
    assert stream["codec_name"] == codec and stream["pix_fmt"] == "yuv420p"
    assert (stream["width"], stream["height"]) == (960, 960)
    assert int(stream["nb_read_frames"]) == 50, "a second of motion and one of the result, at 25 a second"

    # The skin is pale at rest and has the colours of its displacement at the end.
    unpack = ["ffmpeg", "-v", "error", "-i", str(tmp_path / name), "-f", "rawvideo", "-pix_fmt", "gray", "-"]
    pixels = subprocess.run(unpack, capture_output=True, check=True).stdout
    frames = numpy.frombuffer(pixels, numpy.uint8).reshape(50, 960, 960).astype(float)[:, 100:850, :800]
    changes = numpy.abs(frames - frames[0]).mean(axis=(1, 2))
    assert changes[24] > 1 and changes[12] > 0.2 * changes[24]
    assert numpy.abs(frames[49] - frames[25]).mean() < 1, "it stands still at the end"


def test_what_no_film_can_show_is_said(result: pathlib.Path, tmp_path: pathlib.Path) -> None:
    command = [os.environ["LIPOFILL"], "scene", str(result), "--out", str(tmp_path / "a.mp4"), "--colour", "pressure"]
    refused = subprocess.run(command, capture_output=True, text=True, check=False)
    assert refused.returncode == 2 and "a film shows the lift" in refused.stderr
    (tmp_path / "empty").mkdir()
    command = [os.environ["LIPOFILL"], "scene", str(tmp_path / "empty"), "--out", str(tmp_path / "a.mp4")]
    empty = subprocess.run(command, capture_output=True, text=True, check=False)
    assert empty.returncode == 2 and "is not a folder that lipofill run" in empty.stderr
