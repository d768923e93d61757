"""Thickness of layers measured in a label map and in a CT of the same head: a ball of skin, fat,
muscle and bone, whose thickness is known.
"""

import json
import os
import pathlib
import subprocess
from typing import Any, Dict

import numpy
import pytest

RADIUS_MM, VOXEL_MM, SIDE = 70.0, 1.25, 120
CENTRE_MM = numpy.array([300.0, -200.0, 900.0])
DEPTHS_MM = {"skin": 2.5, "subcutaneous": 8.0, "muscle": 18.0}
NAMES = ["Skin", "Subcutaneous fat", "M. masseter", "Mandible", "Dental implant"]
IMPLANT_MM = numpy.array([0.0, -(RADIUS_MM - 17), 10.0])


def run(*arguments: Any, code: int = 0) -> "subprocess.CompletedProcess[str]":
    command = [os.environ["LIPOFILL"], *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == code, (command, done.stdout, done.stderr)
    return done


def places_mm() -> numpy.ndarray:
    """The middles of the voxels relative to that of the head: z, y, x, and what lies there."""
    ends = VOXEL_MM * (numpy.arange(SIDE) - 0.5 * (SIDE - 1))
    z, y, x = numpy.meshgrid(ends, ends, ends, indexing="ij")
    return numpy.stack([x, y, z], axis=-1)


def write_nrrd(file: pathlib.Path, voxels: numpy.ndarray, notes: str = "") -> None:
    kind = {"uint8": "uchar", "int16": "short"}[voxels.dtype.name]
    origin = CENTRE_MM - 0.5 * VOXEL_MM * (SIDE - 1)
    axes = " ".join(f"({','.join(str(VOXEL_MM if a == b else 0) for b in range(3))})" for a in range(3))
    header = (
        f"NRRD0005\ntype: {kind}\ndimension: 3\nspace: left-posterior-superior\nsizes: {SIDE} {SIDE} {SIDE}\n"
        f"space directions: {axes}\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
        f"space origin: ({origin[0]},{origin[1]},{origin[2]})\n{notes}\n"
    )
    file.write_bytes(header.encode() + voxels.tobytes())


def plan_on(skin: pathlib.Path) -> Dict[str, Any]:
    corners = []
    for x, z in ((-30, -30), (30, -30), (30, 30), (-30, 30)):
        y = -numpy.sqrt(RADIUS_MM**2 - x**2 - z**2)
        at = CENTRE_MM + (x, y, z)
        corners.append({"position_mm": {"x": at[0], "y": at[1], "z": at[2]}})
    return {
        "name": "ball",
        "scan": {"file": str(skin)},
        "model": {
            "scan_region": {"corners": corners},
            "n_xi": 24,
            "n_eta": 24,
            "tissue_preset": "ELASTOGRAPHY",
            "layers": [{"name": name} for name in DEPTHS_MM],
        },
        "simulation": {
            "fat": {"viscosity_pa_s": 15},
            "films": [
                {
                    "name": "deep",
                    "below_layer": "subcutaneous",
                    "zones": [
                        {"name": "front", "box": {"xi_min": 0.3, "xi_max": 0.7, "eta_min": 0.3, "eta_max": 0.7}}
                    ],
                }
            ],
            "injections": [{"zone": "front", "volume_ml": 1, "rate_ml_per_s": 1}],
            "time": {"step_ms": 10, "end_s": 120, "goal": "SETTLED_SHAPE"},
        },
    }


@pytest.fixture(scope="module")
def head(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A folder with the labels, a CT, the skin and a plan on it."""
    folder = tmp_path_factory.mktemp("head")
    at = places_mm()
    depth = RADIUS_MM - numpy.linalg.norm(at, axis=-1)
    labels = numpy.digitize(depth, [0.0, *DEPTHS_MM.values()]).astype(numpy.uint8)
    labels[numpy.linalg.norm(at - IMPLANT_MM, axis=-1) < 3] = 5
    notes = "".join(f"Segment{k}_LabelValue:={k + 1}\nSegment{k}_Name:={name}\n" for k, name in enumerate(NAMES))
    write_nrrd(folder / "labels.seg.nrrd", labels, notes)
    values = numpy.array([-1000, 40, -100, 60, 1200, 3071], dtype=numpy.int16)[labels]
    write_nrrd(folder / "ct.nrrd", values)
    run("scan", "extract", folder / "labels.seg.nrrd", "--label", "all", "--smooth", 20, "--out", folder / "skin.ply")
    (folder / "plan.json").write_text(json.dumps(plan_on(folder / "skin.ply")))
    return folder


def by_name(figures: Dict[str, Any]) -> Dict[str, Any]:
    return {layer["name"]: layer for layer in figures["layers"]}


def test_every_layer_of_a_label_map_is_measured(head: pathlib.Path, tmp_path: pathlib.Path) -> None:
    measure = ("thickness", head / "plan.json", head / "labels.seg.nrrd", "--out", tmp_path / "measured", "--spawn")
    figures = json.loads(run(*measure, "--json").stdout)
    assert figures == {**json.loads((tmp_path / "measured/thickness.json").read_text()), "plan": figures["plan"]}
    layers = by_name(figures)
    above = 0.0
    for name, depth in DEPTHS_MM.items():
        layer = layers[name]
        assert layer["mean_mm"] == pytest.approx(depth - above, abs=0.25), name
        assert layer["standard_deviation_mm"] < 0.3, name
        assert layer["least_mm"] <= layer["percentile_5_mm"] <= layer["median_mm"] <= layer["percentile_95_mm"]
        assert layer["measured_share"] + layer["default_share"] == pytest.approx(1)
        above = depth
    # The implant shines in the muscle, and within its reach of 10 mm.
    assert 0.05 < layers["muscle"]["metal_share"] < 0.4
    assert layers["muscle"]["default_share"] == pytest.approx(layers["muscle"]["metal_share"])
    assert "label 3 (M. masseter) is muscle" in figures["remarks"]
    assert (tmp_path / "measured/thickness.vtp").stat().st_size > 1000
    assert (tmp_path / "measured/thickness.png").read_bytes().startswith(b"\x89PNG")

    # The plan runs, and says what was measured of it.
    run("run", tmp_path / "measured/plan.json", "--out", tmp_path / "result", "--spawn")
    summary = json.loads((tmp_path / "result/summary.json").read_text())
    (remark,) = [each for each in summary["remarks"] if "muscle is measured at" in each]
    assert f"{100 * layers['muscle']['measured_share']:.1f} % of the region" in remark
    assert "the figure of its kind stands" in remark


def test_in_a_ct_the_innermost_layer_goes_down_to_bone(head: pathlib.Path, tmp_path: pathlib.Path) -> None:
    measure = ("thickness", head / "plan.json", head / "ct.nrrd", "--out", tmp_path, "--spawn")
    told = run(*measure).stdout
    assert "muscle" in told and "metal is near at" in told
    assert "skin           as the plan has it: the volume does not show it" in told
    figures = json.loads((tmp_path / "thickness.json").read_text())
    muscle = by_name(figures)["muscle"]
    # The preset has 1.8 mm of skin and 3 mm of fat.
    assert muscle["mean_mm"] == pytest.approx(18.0 - 4.8, abs=0.8)
    assert figures["untouched"] == ["skin", "subcutaneous"]


def test_what_cannot_be_measured_is_said(head: pathlib.Path, tmp_path: pathlib.Path) -> None:
    def refusal(volume: pathlib.Path, *more: Any) -> str:
        return run("thickness", head / "plan.json", volume, "--out", tmp_path, "--spawn", *more, code=2).stderr

    assert "has no label named" in refusal(head / "labels.seg.nrrd", "--labels", "bone=Femur")
    assert "is no tissue and label" in refusal(head / "labels.seg.nrrd", "--labels", "liver=2")
    ones = numpy.ones((SIDE, SIDE, SIDE), numpy.uint8)
    write_nrrd(tmp_path / "unnamed.nrrd", ones, "Segment0_LabelValue:=1\nSegment0_Name:=x\n")
    assert "none is named as a tissue" in refusal(tmp_path / "unnamed.nrrd")
    write_nrrd(tmp_path / "air.nrrd", numpy.full((SIDE, SIDE, SIDE), -1000, numpy.int16))
    air = run("thickness", head / "plan.json", tmp_path / "air.nrrd", "--out", tmp_path, "--spawn", code=4).stderr
    assert "nothing was measured" in air
