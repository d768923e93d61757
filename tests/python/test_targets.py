"""Targets from the healthy side and from surfaces, and deficits, on a head made by a formula."""

import numpy as np
import pytest

import lipofill
from lipofill.errors import FailedPreconditionError, InvalidArgumentError

N = 60
PAIRS = {
    "exocanthion": (0.5, 0.3, 0.8),
    "cheilion": (0.3, -0.4, 0.95),
    "zygion": (0.9, 0.05, 0.35),
    "gonion": (0.7, -0.65, 0.2),
}
MIDLINE = {
    "nasion": (0, 0.25, 1),
    "pronasale": (0, -0.05, 1),
    "pogonion": (0, -0.75, 0.8),
    "menton": (0, -0.95, 0.7),
}
BUMPS = [((0, -0.05, 1), 0.16, 22.0), ((0, -0.75, 0.8), 0.25, 12.0), ((0, 0.8, -0.6), 0.5, 6.0)]
for side in (-1.0, 1.0):
    BUMPS += [((side * 0.35, 0.35, 0.9), 0.2, 6.0), ((side * 0.6, -0.1, 0.75), 0.25, 7.0)]
    BUMPS += [((side, 0.0, -0.1), 0.15, 20.0)]


def skin_at(directions, bumps):
    """Points of the head [mm] in these directions from its middle."""
    u = np.atleast_2d(directions) / np.linalg.norm(np.atleast_2d(directions), axis=1, keepdims=True)
    radius = 1.0 / np.sqrt((u[:, 0] / 75) ** 2 + (u[:, 1] / 110) ** 2 + (u[:, 2] / 95) ** 2)
    for direction, width, height in bumps:
        cosine = u @ (np.asarray(direction) / np.linalg.norm(direction))
        radius = radius + height * np.exp(-((np.arccos(np.clip(cosine, -1, 1)) / width) ** 2))
    return u * radius[:, None]


def write_head(path, bumps, turn=None):
    polar, around = np.meshgrid(np.pi * np.arange(1, N) / N, np.pi * np.arange(2 * N) / N, indexing="ij")
    ring = np.stack([np.sin(polar) * np.sin(around), np.cos(polar), np.sin(polar) * np.cos(around)], axis=-1)
    points = skin_at(np.vstack([[[0, 1, 0], [0, -1, 0]], ring.reshape(-1, 3)]), bumps)
    if turn is not None:
        points = points @ turn.T + np.array([100.0, -50.0, 30.0])
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in points]
    index = lambda r, k: 3 + (r - 1) * 2 * N + k % (2 * N)
    for k in range(2 * N):
        lines.append(f"f 1 {index(1, k)} {index(1, k + 1)}")
        lines.append(f"f 2 {index(N - 1, k + 1)} {index(N - 1, k)}")
        for r in range(1, N - 1):
            lines.append(f"f {index(r, k)} {index(r + 1, k)} {index(r + 1, k + 1)} {index(r, k + 1)}")
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture(scope="module")
def landmarks():
    places = {name: skin_at(direction, BUMPS)[0].tolist() for name, direction in MIDLINE.items()}
    for name, (x, y, z) in PAIRS.items():
        places[f"{name}_left"] = skin_at((x, y, z), BUMPS)[0].tolist()
        places[f"{name}_right"] = skin_at((-x, y, z), BUMPS)[0].tolist()
    return places


@pytest.fixture(scope="module")
def scans(connection, tmp_path_factory):
    """A head whose left cheek has sunk in, and the same head before, turned."""
    folder = tmp_path_factory.mktemp("heads")
    patient = connection.patients.create().name
    sunk = BUMPS + [((0.75, -0.35, 0.4), 0.25, -5.0)]
    turn = np.linalg.qr(np.array([[1.0, 2.0, 0.3], [-0.5, 1.0, 1.0], [0.2, -1.0, 2.0]]))[0]
    turn *= np.linalg.det(turn)
    return (
        connection.scans.upload(patient, write_head(folder / "face.obj", sunk)).name,
        connection.scans.upload(patient, write_head(folder / "before.obj", BUMPS, turn)).name,
    )


def test_the_healthy_side_says_what_the_other_lacks(connection, scans, landmarks):
    face, _ = scans
    target = connection.targets.mirror(face, landmarks, healthy_side="right")
    assert target.report.mirrored_side == "right" and target.report.scan == face
    assert abs(target.report.plane.normal.x - 1.0) < 1e-4
    assert connection.scans.get(target.scan).report.target == target.report
    deficit = connection.targets.deficit(face, target.scan, landmarks=landmarks)
    regions = {region.region: region for region in deficit.regions}
    assert deficit.all.volume.deficit_ml > 1.0
    assert regions["masseter_left"].volume.deficit_ml > 10 * regions["masseter_right"].volume.deficit_ml
    distances = np.array(deficit.distance_mm)
    assert np.nanmin(distances) == pytest.approx(-deficit.all.max_deficit_mm, abs=1e-4)
    assert np.isnan(distances).any(), "skin far from the face is not compared"


def test_an_earlier_scan_is_placed_by_its_shape(connection, scans, landmarks):
    face, before = scans
    target = connection.targets.place(face, before, landmarks=landmarks)
    assert target.report.registration.start == "shape"
    assert target.report.registration.confidence > 0.1


    figures = connection.targets.deficit(face, target.scan, landmarks=landmarks, figures_only=True)
    assert len(figures.distance_mm) == 0 and figures.all.volume.excess_ml < 0.1 * figures.all.volume.deficit_ml


def test_what_cannot_be_placed_is_refused_with_figures(connection, scans, landmarks):
    face, before = scans
    with pytest.raises(FailedPreconditionError, match="cannot be placed on the face with confidence"):
        connection.targets.place(face, before, in_place=True)
    with pytest.raises(InvalidArgumentError):
        connection.targets.mirror(face, landmarks, healthy_side="top")
    with pytest.raises(lipofill.LipofillError):
        connection.targets.mirror(face, {}, healthy_side="left")
