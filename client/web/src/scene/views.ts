// Where to look from, so that a surgeon sees what matters first.
import type { Mesh } from "../api/meshes";
import { computeNormals, type Point } from "./surface_geometry";
import { trianglesOf } from "../api/meshes";
import type { CameraPose } from "./viewport";

export interface Axes {
  left: Point;
  up: Point;
  forward: Point;
}

export interface View {
  focus: Point;
  direction: Point;
  up: Point;
  halfHeight: number;
}

const unit = (v: Point): Point => {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length) as Point;
};

function boxOf(points: ArrayLike<number>): { centre: Point; half: Point } {
  const low: Point = [Infinity, Infinity, Infinity];
  const high: Point = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < points.length; ++k) {
    low[k % 3] = Math.min(low[k % 3], points[k]);
    high[k % 3] = Math.max(high[k % 3], points[k]);
  }
  return { centre: low.map((v, c) => (v + high[c]) / 2) as Point, half: low.map((v, c) => (high[c] - v) / 2) as Point };
}

/** The views of clinical photographs: how far the camera goes to the patient's left [degrees]. */
export const standardTurns = { right: -90, right_oblique: -45, front: 0, left_oblique: 45, left: 90 };
export type StandardView = keyof typeof standardTurns;

/** The whole face in a standard view; all of them are from equally far away. */
export function faceView(face: Mesh, axes: Axes, which: StandardView): View {
  const { centre, half } = boxOf(face.points);
  const turn = (standardTurns[which] * Math.PI) / 180;
  const direction = axes.forward.map((v, c) => Math.cos(turn) * v + Math.sin(turn) * axes.left[c]) as Point;
  return { focus: centre, direction: unit(direction), up: axes.up, halfHeight: 1.12 * Math.max(...half) };
}

/** The same view of the other side: the camera mirrored at the plane between both. */
export function contralateral(pose: CameraPose, middle: Point, left: Point): CameraPose {
  const dot = (v: Point): number => v[0] * left[0] + v[1] * left[1] + v[2] * left[2];
  const turned = (v: Point): Point => v.map((x, c) => x - 2 * dot(v) * left[c]) as Point;
  const place = (p: Point): Point =>
    turned(p.map((x, c) => x - middle[c]) as Point).map((x, c) => x + middle[c]) as Point;
  return { position: place(pose.position), focus: place(pose.focus), up: turned(pose.up) };
}

export const middleOf = (face: Mesh): Point => boxOf(face.points).centre;

/** The region of the model, from in front of it, with what a face is recognised by around it. */
export function regionView(skin: Mesh, axes: Axes, flat: boolean): View {
  const { centre, half } = boxOf(skin.points);
  if (flat)
    return { focus: centre, direction: unit([0.2, -0.75, 0.65]), up: [0, 0, 1], halfHeight: 1.05 * Math.max(...half) };
  const normals = new Float32Array(skin.points.length);
  computeNormals(skin.points, trianglesOf(skin), normals);
  const mean: Point = [0, 0, 0];
  for (let k = 0; k < normals.length; ++k) mean[k % 3] += normals[k];
  const outward = unit(mean);
  const direction = unit(outward.map((v, c) => v + 0.45 * axes.forward[c]) as Point);
  return { focus: centre, direction, up: axes.up, halfHeight: Math.max(88, 2.1 * Math.max(...half)) };
}

/** From outside of where the skin has moved, weighted by how far. */
export function liftView(points: ArrayLike<number>, normals: Float32Array, moved: Float32Array, axes: Axes): View {
  const focus: Point = [0, 0, 0];
  const outward: Point = [0, 0, 0];
  let total = 0;
  for (let k = 0; k < moved.length; ++k) {
    total += moved[k];
    for (let c = 0; c < 3; ++c) {
      focus[c] += moved[k] * points[3 * k + c];
      outward[c] += moved[k] * normals[3 * k + c];
    }
  }
  const direction = unit(unit(outward).map((v, c) => v + 0.35 * axes.forward[c]) as Point);
  return { focus: focus.map((v) => v / (total || 1)) as Point, direction, up: axes.up, halfHeight: 92 };
}
