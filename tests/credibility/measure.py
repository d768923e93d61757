#!/usr/bin/env python3
"""Measures on real runs what core/doc/credibility.md compares with published figures, and writes it
to a file.

    measure.py LIPOFILL OUT.json [--faces FOLDER]

LIPOFILL is the program; a private daemon does the work. For every region, plane and face it injects
a volume, lets the tissue come to rest, and takes the surface-volume coefficient: the volume that
the skin has gained over the volume injected. The same program, on the same kind of processor, gives
the same file.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
OWN_FACE = ROOT / "client/examples/faces/half_face.obj"

PLANES = ("skin", "subcutaneous", "smas", "muscle")

# Thickness of the deepest layer by region, in mm; masseter and temporalis as published for the
# masseter, mimic muscles assumed.
MUSCLE_MM = {"temple": 10.0, "masseter": 10.0, "buccal": 8.0, "mandibular_angle": 10.0}
MIMIC_MUSCLE_MM = 3.0

# Regions of the cadaver study are tried in every plane, the others in two.
CADAVER_REGIONS = ("soof", "forehead", "temple", "midface")
FILLER_REGIONS = ("malar", "nasolabial", "marionette", "chin", "jawline", "masseter")
LIPS = ("upper_lip", "lower_lip")
FILLER_PLANES = ("skin", "subcutaneous")

VOLUMES_ML = {"upper_lip": 0.3, "lower_lip": 0.3, "soof": 0.3, "nasolabial": 0.5, "marionette": 0.3}
VOLUME_ML = 1.0

# So many faces of a folder take part, by name.
MOST_FACES = 2


def cases():
    for region in CADAVER_REGIONS:
        for plane in PLANES:
            yield region, plane
    for region in FILLER_REGIONS + LIPS:
        for plane in FILLER_PLANES:
            yield region, plane


def faces(folder):
    """The project's own face, and those of a folder: surface and landmarks by name."""
    found = [("synthetic half face", OWN_FACE, OWN_FACE.with_suffix(".landmarks.json"))]
    for landmarks in sorted(folder.glob("head_*.landmarks.json"))[:MOST_FACES] if folder else []:
        stem = landmarks.name.removesuffix(".landmarks.json")
        found.append((stem, landmarks.parent / f"{stem}.ply", landmarks))
    return found


def plan(region, plane, surface, landmarks):
    layers = [{"name": name} for name in PLANES]
    layers[3]["thickness_mm"] = {"constant": MUSCLE_MM.get(region, MIMIC_MUSCLE_MM)}
    return {
        "name": f"{region}_{plane}",
        "scan": {"file": str(surface), "unit": "MILLIMETRE", "landmarks_file": str(landmarks)},
        "model": {"scan_region": {}, "tissue_preset": "ELASTOGRAPHY", "layers": layers},
        "simulation": {
            "films": [
                {"name": "film", "below_layer": plane, "zones": [{"name": region, "region": f"{region}_left"}]}
            ],
            "injections": [
                {"zone": region, "volume_ml": VOLUMES_ML.get(region, VOLUME_ML), "rate_ml_per_s": 1.0}
            ],
        },
    }


def measure(lipofill, region, plane, surface, landmarks):
    """The figures of a run; only the reason of one that did not come to rest."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "plan.json"
        file.write_text(json.dumps(plan(region, plane, surface, landmarks)))
        command = [lipofill, "run", str(file), "--out", f"{folder}/out", "--spawn", "--discard", "--fast"]
        done = subprocess.run([*command, "--no-picture", "--json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return {"reason": done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "no reason was given"}
    summary = json.loads(done.stdout)
    if summary["state"] != "SETTLED":
        return {"reason": f"the simulation is {summary['state']}"}
    return {
        "coefficient": summary["skin_volume_change_ml"] / summary["injected_ml"],
        "injected_ml": summary["injected_ml"],
        "mean_pressure_pa": summary["zones"][0]["mean_pressure_pa"],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lipofill")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--faces", type=pathlib.Path, help="a folder of head_*.ply with landmarks beside them")
    arguments = parser.parse_args()
    rows = []
    at_hand = faces(arguments.faces)
    for name, surface, landmarks in at_hand:
        # Every face serves the cadaver study's regions; the project's own serves all.
        for region, plane in cases():
            if name != at_hand[0][0] and region not in CADAVER_REGIONS:
                continue
            figures = measure(arguments.lipofill, region, plane, surface, landmarks)
            rows.append({"face": name, "region": region, "plane": plane, **figures})
            print(f"{name}  {region} below {plane}: {figures}", file=sys.stderr, flush=True)
    arguments.out.write_text(json.dumps({"preset": "ELASTOGRAPHY", "runs": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
