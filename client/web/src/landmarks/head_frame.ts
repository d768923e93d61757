// Which way a face looks: the plane between its sides by how well it mirrors onto itself, and
// forwards and upwards by the nose, which nothing else in that plane is like.
import type { Axes } from "../scene/views";
import type { Point } from "../scene/surface_geometry";
import { NearestVertex } from "./nearest";

export interface HeadFrame extends Axes {
  /** the tip of the nose, nearly [mm] */
  tip: Point;
  /** half of both sides lie nearer to each other's mirror image than this [mm] */
  asymmetryMm: number;
}

/** Points that planes are tried with, and that the best is brought to its place with. */
const [tried, sampled] = [500, 1500];
const faceMm = 85;
/** A point that stands out less than this is no nose [mm]. */
const leastNose = 20;

export const dot = (a: ArrayLike<number>, b: ArrayLike<number>): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Point, b: Point): Point => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const unit = (v: Point): Point => v.map((x) => x / (Math.hypot(...v) || 1)) as Point;
export const along = (p: Point, by: number, axis: Point): Point => p.map((v, c) => v + by * axis[c]) as Point;

/** Eigenvectors of the matrix [xx, xy, xz, yy, yz, zz], the largest value first (Jacobi). */
export function eigenvectors([xx, xy, xz, yy, yz, zz]: number[]): Point[] {
  const a = [
    [xx, xy, xz],
    [xy, yy, yz],
    [xz, yz, zz],
  ];
  const v = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ];
  for (let sweep = 0; sweep < 30; ++sweep)
    for (const [p, q] of [
      [0, 1],
      [0, 2],
      [1, 2],
    ]) {
      if (Math.abs(a[p][q]) < 1e-300) continue;
      const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      const t = Math.sign(theta || 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
      const [c, s] = [1 / Math.sqrt(t * t + 1), t / Math.sqrt(t * t + 1)];
      for (let k = 0; k < 3; ++k) [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
      for (let k = 0; k < 3; ++k) [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
      for (let k = 0; k < 3; ++k) [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
    }
  return [0, 1, 2].sort((i, j) => a[j][j] - a[i][i]).map((k) => [v[0][k], v[1][k], v[2][k]] as Point);
}

function scatter(points: Point[]): number[] {
  const sum = [0, 0, 0, 0, 0, 0];
  for (const [x, y, z] of points) [x * x, x * y, x * z, y * y, y * z, z * z].forEach((v, k) => (sum[k] += v));
  return sum;
}

const median = (values: number[]): number => [...values].sort((a, b) => a - b)[values.length >> 1] ?? Infinity;

interface Plane {
  normal: Point;
  offset: number;
  residual: number;
}

const mirrored = (p: Point, { normal, offset }: Plane): Point => along(p, -2 * (dot(p, normal) - offset), normal);

/** Brings a plane to where the points mirror onto the surface, and says how well they do. */
function refine(start: Plane, points: Point[], surface: NearestVertex, all: ArrayLike<number>, rounds: number): Plane {
  let plane = start;
  for (let round = 0; round <= rounds; ++round) {
    const pairs = points.map((p) => {
      const found = surface.find(mirrored(p, plane));
      if (!found) return { apart: 40, p, q: p };
      const at = 3 * found.vertex;
      return { apart: found.apart, p, q: [all[at], all[at + 1], all[at + 2]] as Point };
    });
    const residual = median(pairs.map(({ apart }) => apart));
    plane = { ...plane, residual };
    if (round === rounds) return plane;
    const near = pairs.filter(({ apart, p, q }) => apart < 2.5 * residual + 1 && Math.hypot(...along(p, -1, q)) > 20);
    if (near.length < 20) return plane;
    const [normal] = eigenvectors(scatter(near.map(({ p, q }) => along(p, -1, q))));
    const turned = dot(normal, plane.normal) < 0 ? (normal.map((v) => -v) as Point) : normal;
    plane = { ...plane, normal: turned, offset: median(near.map(({ p, q }) => (dot(p, turned) + dot(q, turned)) / 2)) };
  }
  return plane;
}

interface Nose {
  axes: Axes;
  tip: Point;
  score: number;
}

/** How much the foremost point of the plane is like a nose, looking along `forward`. */
function noseOf(points: ArrayLike<number>, plane: Plane, forward: Point, up: Point): Nose {
  const left = cross(up, forward);
  const offset = dot(left, plane.normal) > 0 ? plane.offset : -plane.offset;
  const profile = new Map<number, number>();
  const flank = new Map<number, number>();
  let tip: Point = [0, 0, 0];
  let foremost = -Infinity;
  const binOf = (u: number): number => Math.round(u / 3);
  for (let k = 0; k < points.length; k += 3) {
    const p: Point = [points[k], points[k + 1], points[k + 2]];
    const [x, f] = [Math.abs(dot(p, left) - offset), dot(p, forward)];
    const bin = binOf(dot(p, up));
    if (x < 5) {
      if (f > (profile.get(bin) ?? -Infinity)) profile.set(bin, f);
      if (f > foremost) [foremost, tip] = [f, p];
    } else if (x > 22 && x < 30 && f > (flank.get(bin) ?? -Infinity)) flank.set(bin, f);
  }
  const at = (of: Map<number, number>, du: number): number | undefined => {
    const bin = binOf(dot(tip, up) + du);
    for (const by of [0, 1, -1, 2, -2]) if (of.has(bin + by)) return of.get(bin + by);
    return undefined;
  };
  const axes = { left, up, forward };
  const side = at(flank, 0);
  const [ridge, lip, root, mouth] = [18, -18, 35, -35].map((du) => at(profile, du));
  const [brow, chin] = [at(profile, 45), at(profile, -45)];
  if ([side, ridge, lip, root, mouth, brow, chin].some((v) => v === undefined)) return { axes, tip, score: -Infinity };
  const falls = Math.min(35, foremost - side!);
  // The ridge of a nose falls slowly and far, what is below it at once and less.
  const lean = Math.max(-20, Math.min(20, ridge! - lip! + mouth! - root!));
  const flat = Math.max(0, foremost - brow! - 45) + Math.max(0, foremost - chin! - 45);
  return { axes, tip, score: falls + 2 * lean - flat };
}

/** Forwards and upwards along two axes, every way around. */
const turnsOf = (one: Point, other: Point): [Point, Point][] =>
  [
    [one, other],
    [other, one],
  ].flatMap(([a, b]): [Point, Point][] => {
    const [c, d] = [a, b].map((v) => v.map((x) => -x) as Point);
    return [
      [a, b],
      [a, d],
      [c, b],
      [c, d],
    ];
  });

/** Undefined where nothing of the surface is like a nose between two sides that mirror. */
export function findHead(points: ArrayLike<number>, surface: NearestVertex): HeadFrame | undefined {
  const count = points.length / 3;
  const stride = Math.max(1, Math.floor(count / sampled));
  const sample: Point[] = [];
  for (let k = 0; k < count; k += stride) sample.push([points[3 * k], points[3 * k + 1], points[3 * k + 2]]);
  const few = sample.filter((_, k) => k % Math.ceil(sample.length / tried) === 0);
  const centre = [0, 1, 2].map((c) => median(sample.map((p) => p[c]))) as Point;
  const own = eigenvectors(scatter(sample.map((p) => along(p, -1, centre))));
  const frames: Point[][] = [
    [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ],
    own,
  ];
  const planes = frames
    .flatMap((frame) => frame.map((normal, k) => ({ normal, second: frame[(k + 1) % 3] })))
    .map(({ normal, second }) => ({
      second,
      plane: refine({ normal, offset: dot(centre, normal), residual: 0 }, few, surface, points, 5),
    }));
  const least = Math.min(...planes.map(({ plane }) => plane.residual));
  let best: (Nose & { plane: Plane }) | undefined;
  const looked: Point[] = [];
  for (const { plane, second } of planes) {
    if (plane.residual > 1.3 * least + 0.5) continue;
    // Both sets of axes often lead to one plane.
    if (looked.some((normal) => Math.abs(dot(normal, plane.normal)) > 0.995)) continue;
    looked.push(plane.normal);
    const flat = unit(along(second, -dot(second, plane.normal), plane.normal));
    for (const [forward, up] of turnsOf(flat, cross(plane.normal, flat))) {
      const nose = noseOf(points, plane, forward, up);
      if (nose.score > leastNose && nose.score > (best?.score ?? -Infinity)) best = { ...nose, plane };
    }
  }
  if (!best) return undefined;
  const { axes, tip, plane } = best;
  const front = sample.filter((p) => Math.hypot(...along(p, -1, tip)) < faceMm);
  const fine = refine(plane, front, surface, points, 8);
  const left = dot(fine.normal, axes.left) > 0 ? fine.normal : (fine.normal.map((v) => -v) as Point);
  const offset = dot(left, fine.normal) > 0 ? fine.offset : -fine.offset;
  const forward = unit(along(axes.forward, -dot(axes.forward, left), left));
  const middle = along(tip, offset - dot(tip, left), left);
  return { left, forward, up: cross(forward, left), tip: middle, asymmetryMm: fine.residual };
}
