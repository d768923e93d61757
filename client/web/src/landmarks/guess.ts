// A first guess of the landmarks of a face, for somebody to confirm.
//
// The plane between both sides comes from the face's own symmetry. The landmarks in it are where
// the profile has its tip, its deepest places and its chin. Those beside it are where they lie on a
// mean face of the same length, brought onto the skin.
import type { Coordinates } from "../api/meshes";
import { placeNear, pointAt } from "../scene/measure";
import { castRay, distanceOf, type Point } from "../scene/surface_geometry";
import { along, cross, dot, findHead, unit, type HeadFrame } from "./head_frame";
import { NearestVertex } from "./nearest";
import { cutProfile, findMidline, type Midline } from "./profile";

export interface Guess {
  at: Point;
  /** half of such guesses are nearer than this [mm] */
  uncertaintyMm: number;
}

export interface Guesses {
  points: Record<string, Guess>;
  frame: HeadFrame;
}

/**
 * Left of the plane, over and before the nasion [mm]: means over simulated heads and masks, upright
 * by the line from nasion to pogonion. Heights are for a face whose nasion is 113 mm over its
 * menton: they go with its length, and breadth and depth do not. `from` is the side on which the
 * skin is looked for.
 */
const meanFace: Record<string, { place: Point; from: "forward" | "left" }> = {
  exocanthion: { place: [45.6, -4.5, -23.5], from: "forward" },
  alare: { place: [17, -41, 0], from: "forward" },
  cheilion: { place: [25.3, -70.5, -7.5], from: "forward" },
  gonion: { place: [59.7, -80, -73], from: "left" },
  zygion: { place: [71.8, -20.5, -61], from: "left" },
  tragion: { place: [73, -20, -87], from: "left" },
};
const meanLengthMm = 113;
/** Skin that is further from the mean is that of something else. */
const mostOffMm = 22;

/** Median distances to landmarks set by hand, of faces that are not of this project [mm]. */
const uncertainty: Record<string, number> = {
  nasion: 3,
  pronasale: 3,
  subnasale: 2,
  pogonion: 2,
  menton: 3,
  exocanthion: 5,
  alare: 4,
  cheilion: 3,
  gonion: 5,
  zygion: 6,
  tragion: 7,
};

/** Upright by the line from nasion to pogonion, about the axis through both sides. */
function upright(frame: HeadFrame, nasion: Point, pogonion: Point): HeadFrame {
  const line = along(nasion, -1, pogonion);
  const up = unit(along(line, -dot(line, frame.left), frame.left));
  return { ...frame, up, forward: cross(frame.left, up) };
}

interface Ground {
  points: Coordinates;
  triangles: Uint32Array;
  surface: NearestVertex;
}

/** Frame and profile, upright. */
function readProfile({ points, triangles, surface }: Ground) {
  let frame = findHead(points, surface);
  if (frame === undefined) return undefined;
  for (let round = 0; ; ++round) {
    const profile = cutProfile(points, triangles, frame);
    const midline = findMidline(profile);
    if (midline === undefined) return undefined;
    if (round === 2) return { frame, profile, midline };
    frame = upright(frame, profile.pointAt(midline.nasion), profile.pointAt(midline.pogonion));
  }
}

/**
 * Where the skin is, seen from a side; else where it is nearest. Undefined where the scan ended.
 */
function onSkin({ points, triangles, surface }: Ground, wanted: Point, outward: Point): Point | undefined {
  const inward = outward.map((v) => -v) as Point;
  const hit = castRay(points, triangles, along(wanted, mostOffMm, outward), inward);
  if (hit && hit.distance < 2 * mostOffMm) return hit.point;
  const near = surface.find(wanted);
  if (near === undefined || near.apart > mostOffMm / 2) return undefined;
  return pointAt(points, triangles, placeNear(points, triangles, wanted));
}

/** Undefined where the surface shows no nose and chin in a plane that it mirrors at. */
export function guessLandmarks(points: Coordinates, triangles: Uint32Array): Guesses | undefined {
  const ground = { points, triangles, surface: new NearestVertex(points) };
  const read = readProfile(ground);
  if (read === undefined) return undefined;
  const { frame, profile, midline } = read;
  const found: Record<string, Guess> = {};
  for (const name of Object.keys(midline) as (keyof Midline)[])
    found[name] = { at: profile.pointAt(midline[name]), uncertaintyMm: uncertainty[name] };
  const nasion = found.nasion.at;
  const scale = distanceOf(nasion, found.menton.at) / meanLengthMm;
  const { left, up, forward } = frame;
  for (const [name, { place, from }] of Object.entries(meanFace))
    for (const [side, sign] of [
      ["left", 1],
      ["right", -1],
    ] as const) {
      const [x, y, z] = [sign * place[0], scale * place[1], place[2]];
      const wanted = along(along(along(nasion, x, left), y, up), z, forward);
      const at = onSkin(ground, wanted, from === "forward" ? forward : (left.map((v) => sign * v) as Point));
      if (at) found[`${name}_${side}`] = { at, uncertaintyMm: uncertainty[name] };
    }
  return { points: found, frame };
}
