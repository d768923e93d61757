"""A plan for a face out of what is chosen in the panel."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Dict, Iterable, List, Mapping, Sequence, Tuple

import lipofill
from lipofill.landmark_names import understand_name
from lipofill.v1 import model_pb2

Point = Tuple[float, float, float]
#: The regions that the daemon places from landmarks, on either side of the face.
REGIONS = (
    "masseter",
    "mandibular_angle",
    "buccal",
    "malar",
    "zygomatic",
    "soof",
    "tear_trough",
    "midface",
    "nasolabial",
    "upper_lip",
    "lower_lip",
    "marionette",
    "chin",
    "jawline",
    "submaxillary",
    "temple",
    "forehead",
)
#: The planes between layers that fat goes into, and the layer above each.
PLANES = {"subcutaneous (under the skin)": "skin", "deep (on the muscle)": "subcutaneous"}
#: How fine the model is: hexahedra along both sides of it.
RESOLUTIONS = {"standard": (40, 32), "coarse, quickest": (24, 20), "fine, four times as long": (60, 48)}
RATE_ML_PER_S = 1.0


@dataclass(frozen=True)
class Zone:
    """Fat for a region.

    Attributes
    ----------
    region : str
        With its side: "malar_left".
    volume_ml : float
    """

    region: str
    volume_ml: float


@dataclass
class Choices:
    """What is chosen in the panel.

    Attributes
    ----------
    zones : list of Zone
    plane : str
        One of PLANES.
    resolution : str
        One of RESOLUTIONS.
    settled_only : bool
        The settled shape alone, found directly; else the fat is watched while it is injected.
    """

    zones: List[Zone] = field(default_factory=list)
    plane: str = "deep (on the muscle)"
    resolution: str = "standard"
    settled_only: bool = False


def name_landmarks(labelled_lps: Sequence[Tuple[str, Point]]) -> Tuple[Dict[str, Point], List[str]]:
    """Landmarks by the daemon's names, and the labels that are none of it.

    Raises
    ------
    lipofill.InvalidArgumentError
        Two labels are the same landmark.
    """
    named: Dict[str, Point] = {}
    label_of: Dict[str, str] = {}
    unknown = []
    for label, point in labelled_lps:
        name = understand_name(label)
        if name is None:
            unknown.append(label)
            continue
        if name in named:
            raise lipofill.InvalidArgumentError(
                f"the landmark {name} is there twice, as '{label_of[name]}' and '{label}'"
            )
        named[name], label_of[name] = point, label
    return named, unknown


def has_pair(landmarks: Iterable[str]) -> bool:
    """Whether a landmark is there on both sides: the axes of the head then follow from it, and are
    otherwise those of LPS.
    """
    names = set(landmarks)
    return any(name.endswith("_left") and name[: -len("left")] + "right" in names for name in names)


def make_plan(
    scan: "str | os.PathLike[str]", landmarks_lps: Mapping[str, Point], choices: Choices, name: str = "slicer"
) -> lipofill.Plan:
    """The plan: a model around the zones, three layers of published stiffness, one film.

    Thicknesses are assumed where nothing was measured: 1.8 mm of skin, 3 mm of fat, 8 mm of muscle.

    Raises
    ------
    lipofill.InvalidArgumentError
        Nothing to inject, a volume that is not above 0 mL, or a region that is there twice.
    """
    if not choices.zones:
        raise lipofill.InvalidArgumentError("the plan has no zone; add one with its volume in mL")
    n_xi, n_eta = RESOLUTIONS[choices.resolution]
    plan = lipofill.Plan(name).face(scan, unit="mm", n_xi=n_xi, n_eta=n_eta)
    for landmark, (x, y, z) in landmarks_lps.items():
        point = plan.model.scan_region.landmarks_mm[landmark]
        point.x, point.y, point.z = x, y, z
    if not has_pair(landmarks_lps):
        axes = plan.model.scan_region.axes
        axes.left.x, axes.up.z, axes.forward.y = 1.0, 1.0, -1.0
    plan.model.tissue_preset = model_pb2.PAPER
    for layer, thickness_mm in (("skin", 1.8), ("subcutaneous", 3.0), ("muscle", 8.0)):
        plan.layer(layer, thickness_mm=thickness_mm)
    plan.simulation.fat.viscosity_pa_s = 15
    zones = [zone.region for zone in choices.zones]
    for zone in choices.zones:
        if not zone.volume_ml > 0:
            raise lipofill.InvalidArgumentError(
                f"the volume of {zone.region} is {zone.volume_ml:g} mL, must be above 0"
            )
        if zones.count(zone.region) > 1:
            raise lipofill.InvalidArgumentError(f"the zone {zone.region} is there twice")
    plan.film("film", below=PLANES[choices.plane], zones={zone: zone for zone in zones}, rest_thickness_mm=0.05)
    for zone in choices.zones:
        plan.inject(zone.region, volume_ml=zone.volume_ml, rate_ml_per_s=RATE_ML_PER_S)
    time = plan.simulation.time
    time.step_ms, time.max_step_ms, time.end_s, time.settle_skin_speed_mm_per_s = 10, 2000, 120, 0.01
    return plan.settle() if choices.settled_only else plan
