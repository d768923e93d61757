// Lengths and angles on a surface. Places are kept as they lie at rest, and found again on whatever
// the surface has become.
import { distanceOf, type Hit, type Point } from "./surface_geometry";

/** A place on a triangle of a surface. */
export type Place = Pick<Hit, "triangle" | "weights">;

export function pointAt(points: ArrayLike<number>, triangles: Uint32Array, { triangle, weights }: Place): Point {
  const at: Point = [0, 0, 0];
  weights.forEach((weight, k) => {
    for (let c = 0; c < 3; ++c) at[c] += weight * points[3 * triangles[triangle + k] + c];
  });
  return at;
}

const minus = (a: Point, b: Point): Point => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: Point, b: Point): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Point, b: Point): Point => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const unit = (v: Point): Point => {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length) as Point;
};
const cornersOf = (points: ArrayLike<number>, triangles: Uint32Array, t: number): Point[] =>
  [0, 1, 2].map((k) => {
    const v = 3 * triangles[t + k];
    return [points[v], points[v + 1], points[v + 2]] as Point;
  });

/** The weights of the point of a triangle that is nearest to another, and how far that is. */
function nearestOn([a, b, c]: Point[], p: Point): { weights: Point; apart: number } {
  const [u, v, w] = [minus(b, a), minus(c, a), minus(p, a)];
  const [uu, uv, vv, wu, wv] = [dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)];
  const determinant = uu * vv - uv * uv || 1;
  const raw = [(vv * wu - uv * wv) / determinant, (uu * wv - uv * wu) / determinant];
  // Beyond an edge the nearest weights are cut off: within a triangle that is exact enough.
  const [s, t] = raw.map((x) => Math.min(1, Math.max(0, x)));
  const over = Math.max(1, s + t);
  const weights: Point = [1 - (s + t) / over, s / over, t / over];
  const at = [0, 1, 2].map((k) => weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k]) as Point;
  return { weights, apart: distanceOf(at, p) };
}

/** The place of a surface that is nearest to a point: on a triangle at the nearest vertex. */
export function placeNear(rest: ArrayLike<number>, triangles: Uint32Array, p: Point): Place {
  let [nearest, least] = [0, Infinity];
  for (let k = 0; k < rest.length; k += 3) {
    const d = (rest[k] - p[0]) ** 2 + (rest[k + 1] - p[1]) ** 2 + (rest[k + 2] - p[2]) ** 2;
    if (d < least) [nearest, least] = [k / 3, d];
  }
  let best: Place = { triangle: 0, weights: [1, 0, 0] };
  let apart = Infinity;
  for (let t = 0; t < triangles.length; t += 3) {
    if (triangles[t] !== nearest && triangles[t + 1] !== nearest && triangles[t + 2] !== nearest) continue;
    const found = nearestOn(cornersOf(rest, triangles, t), p);
    if (found.apart < apart) [best, apart] = [{ triangle: t, weights: found.weights }, found.apart];
  }
  return best;
}

/** The angle at `b` between the straight ways to `a` and `c` [degrees]. */
export function angleAt(a: Point, b: Point, c: Point): number {
  const [u, v] = [minus(a, b), minus(c, b)];
  return (Math.atan2(Math.hypot(...cross(u, v)), dot(u, v)) * 180) / Math.PI;
}

const neighbours = new WeakMap<Uint32Array, Int32Array>();

/** Beyond each edge of each triangle: the first place of its neighbour, -1 where there is none. */
function neighboursOf(triangles: Uint32Array): Int32Array {
  const known = neighbours.get(triangles);
  if (known) return known;
  const beyond = new Int32Array(triangles.length).fill(-1);
  const open = new Map<number, number>();
  const many = triangles.reduce((most, v) => Math.max(most, v), 0) + 1;
  for (let t = 0; t < triangles.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [triangles[t + k], triangles[t + ((k + 1) % 3)]];
      const key = Math.min(a, b) * many + Math.max(a, b);
      const other = open.get(key);
      if (other === undefined) open.set(key, t + k);
      else {
        beyond[t + k] = other - (other % 3);
        beyond[other] = t;
        open.delete(key);
      }
    }
  neighbours.set(triangles, beyond);
  return beyond;
}

/** Across which edges of a triangle a plane goes, and where. */
function crossings(points: ArrayLike<number>, triangles: Uint32Array, t: number, off: (p: Point) => number) {
  const corners = cornersOf(points, triangles, t);
  const sides = corners.map((p) => off(p) || 1e-12);
  return [0, 1, 2].flatMap((k) => {
    const next = (k + 1) % 3;
    if (sides[k] > 0 === sides[next] > 0) return [];
    const share = sides[k] / (sides[k] - sides[next]);
    const at = corners[k].map((v, c) => v + share * (corners[next][c] - v)) as Point;
    return [{ edge: t + k, at }];
  });
}

/**
 * The way along the skin from one place to another, as a tape lies that is laid straight: where the
 * plane through both, upright on the skin, cuts the surface. Undefined where the skin ends between.
 */
export function alongSkin(
  points: ArrayLike<number>,
  triangles: Uint32Array,
  from: Place,
  to: Place,
): { lengthMm: number; path: Point[] } | undefined {
  const [a, b] = [pointAt(points, triangles, from), pointAt(points, triangles, to)];
  const normalAt = (t: number): Point => {
    const [p, q, r] = cornersOf(points, triangles, t);
    return unit(cross(minus(q, p), minus(r, p)));
  };
  const [na, nb] = [normalAt(from.triangle), normalAt(to.triangle)];
  const across = unit(cross(minus(b, a), na.map((v, c) => v + nb[c]) as Point));
  const off = (p: Point): number => dot(minus(p, a), across);
  const beyond = neighboursOf(triangles);
  const walk = (first: { edge: number; at: Point }): Point[] | undefined => {
    const path = [a, first.at];
    let [edge, steps] = [first.edge, 0];
    for (;;) {
      const t = beyond[edge];
      if (t < 0 || ++steps > triangles.length / 3) return undefined;
      if (t === to.triangle) return [...path, b];
      const here = edge - (edge % 3);
      const next = crossings(points, triangles, t, off).find(({ edge: e }) => beyond[e] !== here);
      if (next === undefined) return undefined;
      path.push(next.at);
      edge = next.edge;
    }
  };
  const lengthOf = (path: Point[]): number =>
    path.reduce((sum, p, k) => sum + (k === 0 ? 0 : distanceOf(p, path[k - 1])), 0);
  if (from.triangle === to.triangle) return { lengthMm: distanceOf(a, b), path: [a, b] };
  return crossings(points, triangles, from.triangle, off)
    .map(walk)
    .filter((path) => path !== undefined)
    .map((path) => ({ lengthMm: lengthOf(path), path }))
    .sort((one, other) => one.lengthMm - other.lengthMm)[0];
}
