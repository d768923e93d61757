// The profile of a face: the line in which the plane between both sides cuts it, foremost at each
// height, and the landmarks that are defined on it.
import type { Point } from "../scene/surface_geometry";
import { along, dot, type HeadFrame } from "./head_frame";

const stepMm = 0.5;
const [aboveMm, belowMm] = [105, 125];

export interface Profile {
  /** the foremost place at a height over the tip of the nose [mm]; NaN where there is none */
  forwardAt: (up: number) => number;
  /** back to the face */
  pointAt: (up: number) => Point;
}

export function cutProfile(points: ArrayLike<number>, triangles: Uint32Array, frame: HeadFrame): Profile {
  const { left, up, forward, tip } = frame;
  const count = Math.round((aboveMm + belowMm) / stepMm) + 1;
  const foremost = new Float64Array(count).fill(-Infinity);
  const put = (a: number[], b: number[]): void => {
    const [[u0, f0], [u1, f1]] = a[0] < b[0] ? [a, b] : [b, a];
    const first = Math.max(0, Math.ceil((u0 + belowMm) / stepMm));
    const last = Math.min(count - 1, Math.floor((u1 + belowMm) / stepMm));
    for (let k = first; k <= last; ++k) {
      const share = u1 === u0 ? 0 : (k * stepMm - belowMm - u0) / (u1 - u0);
      foremost[k] = Math.max(foremost[k], f0 + share * (f1 - f0));
    }
  };
  const off = dot(tip, left);
  for (let t = 0; t < triangles.length; t += 3) {
    const cut: number[][] = [];
    const corners = [0, 1, 2].map((k) => {
      const v = 3 * triangles[t + k];
      return [points[v], points[v + 1], points[v + 2]] as Point;
    });
    const x = corners.map((p) => dot(p, left) - off || 1e-9);
    for (let k = 0; k < 3; ++k) {
      const next = (k + 1) % 3;
      if (x[k] > 0 === x[next] > 0) continue;
      const p = along(
        corners[k].map((v) => v * (1 - x[k] / (x[k] - x[next]))) as Point,
        x[k] / (x[k] - x[next]),
        corners[next],
      );
      const from = along(p, -1, tip);
      cut.push([dot(from, up), dot(from, forward)]);
    }
    if (cut.length === 2) put(cut[0], cut[1]);
  }
  // A hole of a scan, or a fold, is bridged by its neighbours.
  const forwardAt = (height: number): number => {
    const place = (height + belowMm) / stepMm;
    const k = Math.round(place);
    for (let reach = 0; reach <= 4; ++reach)
      for (const near of [k - reach, k + reach]) if (foremost[near] > -Infinity) return foremost[near];
    return NaN;
  };
  return { forwardAt, pointAt: (height) => along(along(tip, height, up), forwardAt(height), forward) };
}

/** The height between two at which something is largest. */
export function largest(from: number, to: number, of: (height: number) => number): number {
  let [best, most] = [from, -Infinity];
  for (let height = from; height <= to; height += stepMm) {
    const value = of(height);
    if (value > most) [best, most] = [height, value];
  }
  return best;
}

/** The place that lies deepest behind the chord between two heights. */
export function deepest({ forwardAt }: Profile, from: number, to: number): number {
  const [a, b] = [forwardAt(from), forwardAt(to)];
  const slope = (b - a) / (to - from);
  return largest(from, to, (height) => (a + slope * (height - from) - forwardAt(height)) / Math.hypot(1, slope));
}

export interface Midline {
  nasion: number;
  pronasale: number;
  subnasale: number;
  pogonion: number;
  menton: number;
}

/** The gap between the lips is filled: what is narrower than a fold is no fold of the chin. */
function closed({ forwardAt, pointAt }: Profile): Profile {
  const half = 4.5;
  const around = (u: number, of: (height: number) => number, pick: (...values: number[]) => number): number => {
    let value = of(u);
    for (let by = -half; by <= half; by += 1.5) value = pick(value, of(u + by));
    return value;
  };
  const filled = (u: number): number => around(u, forwardAt, Math.max);
  return { pointAt, forwardAt: (u) => around(u, filled, Math.min) };
}

/** Heights over the tip. Undefined where the profile does not reach from brow to chin. */
export function findMidline(profile: Profile): Midline | undefined {
  const { forwardAt } = profile;
  // A tip is flat: on a head as it is held, its middle is above the foremost place.
  const pronasale = largest(-15, 15, (u) => forwardAt(u) + 0.15 * u);
  const brow = largest(pronasale + 48, pronasale + 78, forwardAt);
  const lip = largest(pronasale - 34, pronasale - 17, (u) => forwardAt(u) - 0.12 * Math.abs(u - pronasale + 25));
  if (Number.isNaN(forwardAt(brow)) || Number.isNaN(forwardAt(pronasale - 75))) return undefined;
  const nasion = deepest(profile, pronasale + 6, brow);
  const subnasale = deepest(profile, lip, pronasale);
  const span = nasion - subnasale;
  // Below the lips lies the fold over the chin, and below that the chin.
  const fold = deepest(closed(profile), subnasale - 0.95 * span, subnasale - 0.35 * span);
  const pogonion = largest(fold - 28, fold - 5, (u) => forwardAt(u) + 0.1 * u);
  const menton = largest(pogonion - 32, pogonion, (u) => 0.9 * forwardAt(u) - u);
  return { nasion, pronasale, subnasale, pogonion, menton };
}
