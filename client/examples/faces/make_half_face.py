#!/usr/bin/env python3
"""Makes half_face.obj and half_face.landmarks.json: the left half of a face that nobody has; or,
for tests, a whole one of other shape.

The head is sculpted from ellipsoids and tapered rods, given as signed distances [mm] and blended
with smooth minima; a grid of rays from a point inside the head samples its outermost surface. Sizes
are those of an average adult. Axes: +x the subject's left, +y up, +z forward; the midline is x = 0.
Standard library only; the same files come out byte for byte on every run.

    make_half_face.py [--out FOLDER]
    make_half_face.py --whole --name long_face --stretch 0.95 1.12 1.0 --step 2 --out FOLDER
"""

import argparse
import json
import math
import os

CENTRE = (0.0, 48.0, 28.0)  # every part of the surface that is sampled can be seen from here
AZIMUTHS = [math.radians(-30.0 + 1.5 * i) for i in range(103)]  # 0 is straight ahead, 90 the left ear
ELEVATIONS = [math.radians(-57.0 + 1.25 * j) for j in range(97)]
FARTHEST = 175.0


def ellipsoid(centre, radii, blend, tilt=0.0):
    """Approximate distance to an ellipsoid, turned about x by `tilt` degrees (top forward)."""
    cx, cy, cz = centre
    rx, ry, rz = radii
    sine, cosine = math.sin(math.radians(tilt)), math.cos(math.radians(tilt))

    def distance(x, y, z):
        px, py, pz = x - cx, y - cy, z - cz
        py, pz = cosine * py + sine * pz, cosine * pz - sine * py
        k0 = math.sqrt((px / rx) ** 2 + (py / ry) ** 2 + (pz / rz) ** 2)
        k1 = math.sqrt((px / rx**2) ** 2 + (py / ry**2) ** 2 + (pz / rz**2) ** 2)
        return k0 * (k0 - 1.0) / k1 if k1 > 1e-12 else -min(radii)

    return distance, blend


def rod(a, b, radius_a, radius_b, blend):
    """Distance to a rod from a to b whose radius changes along it."""
    ax, ay, az = a
    dx, dy, dz = b[0] - ax, b[1] - ay, b[2] - az
    squared = dx * dx + dy * dy + dz * dz

    def distance(x, y, z):
        px, py, pz = x - ax, y - ay, z - az
        t = min(1.0, max(0.0, (px * dx + py * dy + pz * dz) / squared))
        return math.sqrt((px - t * dx) ** 2 + (py - t * dy) ** 2 + (pz - t * dz) ** 2) - (
            radius_a + t * (radius_b - radius_a)
        )

    return distance, blend


# What is joined, in order, each with the length [mm] over which it blends into what is there
# already.
JOINED = [
    # Skull, mid-face, neck.
    ellipsoid((0, 112, 12), (75, 84, 96), 1),
    ellipsoid((0, 62, 40), (57, 76, 58), 34),
    rod((0, -120, -14), (0, 40, 0), 55, 55, 24),
    # Lower jaw: branch, body, chin.
    rod((49, 60, 34), (41, 11, 34), 12, 10, 22),
    rod((41, 11, 34), (30, -6, 64), 10, 9, 22),
    rod((30, -6, 64), (13, -13, 88), 9, 9, 22),
    rod((13, -13, 88), (0, -13, 95), 9, 10, 22),
    ellipsoid((0, -8, 98), (15, 14, 15), 14),
    # Upper jaw and teeth under the lips.
    ellipsoid((0, 36, 92), (26, 18, 20), 18),
    ellipsoid((0, 20, 87), (35, 26, 25.5), 18),
    # Soft tissue: behind the jaw under the ear, cheek before and beside the mouth, masseter, under
    # the eye.
    ellipsoid((43, 36, 10), (20, 52, 26), 30),
    ellipsoid((33, 38, 74), (25, 32, 25), 24),
    ellipsoid((26, 13, 74), (19, 22, 22), 24),
    ellipsoid((42, 34, 50), (18, 32, 24), 24),
    ellipsoid((27, 60, 84), (18, 20, 15), 18),
    # Cheek bone and its arch.
    ellipsoid((42, 67, 75), (17, 11, 16), 20),
    rod((48, 68, 70), (60, 68, 30), 8.5, 7, 20),
    # Brow.
    rod((10, 101, 95.5), (41, 102, 83), 7, 7, 22),
    ellipsoid((0, 104, 99), (16, 11, 9), 16),
]

# Sunk into the sum of the above: eye sockets, temple, furrow between lip and chin.
SUNK_FIRST = [
    ellipsoid((31, 87, 107), (18, 11, 14), 14),
    ellipsoid((17, 84, 107), (7, 12, 10), 10),
    ellipsoid((83, 104, 66), (11, 26, 22), 24),
    rod((0, 4.5, 119.5), (16, 5, 113.5), 4.0, 3.0, 12),
]

DETAILS = [
    # Closed eye: ball under the lids, lower lid.
    ellipsoid((31, 84.5, 84.5), (15.5, 12, 12.5), 5),
    rod((20, 79.5, 92.0), (42, 80.5, 87.5), 2.4, 2.0, 6),
    # Nose: bridge, sides, tip, wings, septum.
    rod((0, 92, 101), (0, 60, 118.5), 4.0, 6.5, 12),
    rod((3.5, 84, 98), (6.5, 54, 110), 4.5, 6.8, 14),
    ellipsoid((0, 56.5, 120.5), (8.5, 7.5, 8.5), 7),
    ellipsoid((12.2, 51.0, 110.5), (5.4, 6.2, 8.2), 6),
    rod((0, 51, 120), (0, 45, 111), 4.0, 4.6, 6),
    # Lips.
    rod((3.5, 26.4, 114.0), (12, 25.0, 110.8), 3.4, 3.1, 5),
    rod((12, 25.0, 110.8), (22, 20.8, 103.0), 3.1, 1.4, 5),
    rod((0, 25.7, 114.0), (4, 26.2, 113.8), 3.2, 3.3, 5),
    rod((0, 14.8, 112.6), (9, 15.3, 110.8), 4.3, 3.9, 5),
    rod((9, 15.3, 110.8), (21.5, 19.2, 102.8), 3.9, 1.4, 5),
    # Ear: lobe, rim, and the little flap in front of its opening.
    ellipsoid((69, 69, 1), (6.5, 24, 13.5), 12, -14),
    rod((73, 80, 10), (75, 92, 2), 3.0, 3.4, 4),
    rod((75, 92, 2), (76.5, 80, -10), 3.4, 3.4, 4),
    rod((76.5, 80, -10), (73, 58, -5), 3.4, 3.0, 4),
    rod((73, 58, -5), (67, 46, 6), 3.0, 4.2, 9),
    ellipsoid((69, 63, 18.5), (4.5, 6, 4), 5),
]

SUNK_LAST = [
    # Line of the mouth, its corner, nostril, groove under the nose, slit and fold of the lids, fold
    # from nose to mouth.
    rod((0, 20.4, 118.6), (11, 20.0, 115.0), 1.6, 1.4, 3),
    rod((11, 20.0, 115.0), (23, 20.2, 105.0), 1.4, 1.5, 3),
    rod((0, 40, 118.8), (0, 31, 119.8), 1.6, 1.8, 4),
    ellipsoid((6.6, 45.6, 115.0), (2.8, 2.2, 4.0), 3),
    rod((18, 82.4, 98.0), (31, 81.4, 99.0), 1.2, 1.2, 3),
    rod((31, 81.4, 99.0), (46, 83.0, 89.0), 1.2, 1.2, 3),
    rod((21, 92.0, 98.0), (43, 91.0, 92.0), 2.0, 1.6, 5),
    rod((19.5, 51, 109), (30, 26, 105), 1.6, 1.4, 9),
    # Hollow of the ear.
    ellipsoid((80.5, 66, 6), (7.5, 11, 7), 5, -14),
    rod((78.5, 78, 3), (78.5, 86, -3), 3.0, 2.6, 4),
]


def smooth_minimum(a, b, k):
    h = max(k - abs(a - b), 0.0) / k
    return min(a, b) - h * h * h * k / 6.0


def distance_to_head(x, y, z):
    """Signed distance to the skin, negative inside. |x| is rounded off at the midline so that the
    two sides meet smoothly.
    """
    x = math.sqrt(x * x + 4.0) - 2.0
    head = 1e9
    for distance, blend in JOINED:
        head = smooth_minimum(head, distance(x, y, z), blend)
    for distance, blend in SUNK_FIRST:
        head = -smooth_minimum(-head, distance(x, y, z), blend)
    for distance, blend in DETAILS:
        head = smooth_minimum(head, distance(x, y, z), blend)
    for distance, blend in SUNK_LAST:
        head = -smooth_minimum(-head, distance(x, y, z), blend)
    return head


def direction(azimuth, elevation):
    return (
        math.cos(elevation) * math.sin(azimuth),
        math.sin(elevation),
        math.cos(elevation) * math.cos(azimuth),
    )


def along(ray, t):
    return tuple(c + t * d for c, d in zip(CENTRE, ray))


def find_skin(ray):
    """Where a ray from the centre leaves the head for good: steps in from far away, then closes in
    by false position (Illinois).
    """
    outside = FARTHEST
    above = distance_to_head(*along(ray, outside))
    while above > 0.05:
        outside -= 0.8 * above
        above = distance_to_head(*along(ray, outside))
    inside, below = outside, above
    while below > 0.0:
        outside, above = inside, below
        inside -= 0.1
        below = distance_to_head(*along(ray, inside))
    while outside - inside > 1e-6 and min(above, -below) > 1e-6:
        middle = (inside * above - outside * below) / (above - below)
        value = distance_to_head(*along(ray, middle))
        if value > 0.0:
            outside, above, below = middle, value, 0.5 * below
        else:
            inside, below, above = middle, value, 0.5 * above
    # Adding 0 turns -0 into 0.
    return tuple(round(c, 3) + 0.0 for c in along(ray, inside if -below < above else outside))


def sample_head():
    """Rows of points, from below to above, each from the right of the midline round to behind the
    left ear.
    """
    return [[find_skin(direction(a, e)) for a in AZIMUTHS] for e in ELEVATIONS]


def sample_whole_head(step):
    """The same rows of a head with both sides, `step` times as coarse: the left one, and its mirror
    image.
    """
    azimuths = [math.radians(1.5 * step * i) for i in range(int(123.0 / (1.5 * step)) + 1)]
    rows = []
    for elevation in ELEVATIONS[::step]:
        left = [find_skin(direction(azimuth, elevation)) for azimuth in azimuths]
        rows.append([(-x, y, z) for x, y, z in reversed(left[1:])] + [(0.0, *left[0][1:])] + left[1:])
    return rows


def reshape(rows, stretch, taper):
    """The head stretched along its axes, and wider above than below by `taper` over 100 mm."""

    def moved(p):
        x, y, z = p
        return (x * stretch[0] * (1.0 + taper * (y - CENTRE[1]) / 100.0), y * stretch[1], z * stretch[2])

    return [[moved(p) for p in row] for row in rows]


def nearest(points, target):
    return min(points, key=lambda p: sum((a - b) ** 2 for a, b in zip(p, target)))


def behind_chord(profile, top, bottom):
    """The point of the profile between two of its points that lies farthest behind the line between
    them.
    """
    (y0, z0), (y1, z1) = top[1:], bottom[1:]
    between = [p for p in profile if y1 < p[1] < y0]
    return max(between, key=lambda p: (z0 + (z1 - z0) * (p[1] - y0) / (y1 - y0)) - p[2])


def find_landmarks(rows, middle, both_sides=False):
    """Indices (row, place in the row) of the landmarks."""
    places = {p: (j, i) for j, row in enumerate(rows) for i, p in enumerate(row)}
    points = list(places)
    profile = [row[middle] for row in rows]

    def most_forward(low, high):
        return max((p for p in profile if low < p[1] < high), key=lambda p: p[2])

    pronasale = most_forward(45, 70)
    upper_lip = most_forward(21, 32)
    found = {
        "nasion": behind_chord(profile, most_forward(98, 115), pronasale),
        "pronasale": pronasale,
        "subnasale": behind_chord(profile, pronasale, upper_lip),
        "pogonion": most_forward(-20, 0),
        "menton": max((p for p in profile if p[1] < 0), key=lambda p: 0.5 * p[2] - p[1]),
    }
    lateral = {
        "exocanthion": (47, 83, 83),
        "cheilion": (23, 20.2, 103),
        "gonion": (57, 10, 32),
        "zygion": (69, 68, 45),
        "tragion": (72, 66, 21),
    }
    for name, (x, y, z) in lateral.items():
        found[name + "_left"] = nearest(points, (x, y, z))
        if both_sides:
            found[name + "_right"] = nearest(points, (-x, y, z))
    if not both_sides:
        found["cheilion_right"] = nearest(points, (-23, 20.2, 103))
    return {name: places[p] for name, p in found.items()}


def write_surface(path, rows):
    width = len(rows[0])
    name = os.path.splitext(os.path.basename(path))[0]
    with open(path, "w", newline="\n") as out:
        out.write(f"# {name}: SYNTHETIC, sculpted by make_half_face.py; nobody has this face. Millimetres.\n")
        out.write("# axes: +x subject left, +y up, +z forward; midline x = 0\n")
        for row in rows:
            for p in row:
                out.write("v %.3f %.3f %.3f\n" % p)
        for j in range(len(rows) - 1):
            for i in range(width - 1):
                a = j * width + i + 1
                out.write("f %d %d %d %d\n" % (a, a + 1, a + width + 1, a + width))


def write_landmarks(path, landmarks):
    description = {
        "surface": os.path.basename(path).replace(".landmarks.json", ".obj"),
        "units": "mm",
        "note": "SYNTHETIC: a face sculpted by make_half_face.py, of no person, for trying the software out",
        "axes": {
            "left": [1.0, 0.0, 0.0],
            "up": [0.0, 1.0, 0.0],
            "forward": [0.0, 0.0, 1.0],
            "note": "unit vectors in the file's own axes; left/right are the SUBJECT's",
        },
        "landmarks": {name: list(p) for name, p in landmarks.items()},
        "method": {
            "midline": "from the profile in the plane x = 0: pronasale, pogonion = most forward; nasion, subnasale = "
            "deepest behind the chords forehead-pronasale and pronasale-upper lip; "
            "menton = farthest along 0.5 forward - 1 up",
            "others": "vertex nearest to where the sculpture has the feature",
        },
        "source": "make_half_face.py",
        "licence": "GPL-3.0-or-later",
    }
    with open(path, "w", newline="\n") as out:
        out.write(json.dumps(description, indent=1) + "\n")


def main():
    parser = argparse.ArgumentParser(description="Makes half_face.obj and half_face.landmarks.json, a synthetic face.")
    parser.add_argument("--out", default=os.path.dirname(os.path.abspath(__file__)), help="folder to write to")
    parser.add_argument("--name", default="half_face", help="of the files")
    parser.add_argument("--whole", action="store_true", help="both sides")
    parser.add_argument("--step", type=int, default=1, help="of a whole head: so many times as coarse")
    parser.add_argument("--stretch", type=float, nargs=3, default=(1.0, 1.0, 1.0), metavar=("X", "Y", "Z"))
    parser.add_argument("--taper", type=float, default=0.0, help="wider above than below, over 100 mm")
    options = parser.parse_args()
    rows = sample_whole_head(options.step) if options.whole else sample_head()
    middle = min(range(len(AZIMUTHS)), key=lambda i: abs(AZIMUTHS[i])) if not options.whole else len(rows[0]) // 2
    places = find_landmarks(rows, middle, options.whole)
    shaped = rows
    if tuple(options.stretch) != (1.0, 1.0, 1.0) or options.taper != 0.0:
        shaped = reshape(rows, options.stretch, options.taper)
    write_surface(os.path.join(options.out, options.name + ".obj"), shaped)
    landmarks = {name: tuple(round(c, 3) for c in shaped[j][i]) for name, (j, i) in places.items()}
    write_landmarks(os.path.join(options.out, options.name + ".landmarks.json"), landmarks)


if __name__ == "__main__":
    main()
