// Where to look at a surface from that nobody has told the axes of.
import type { Surface } from "./surface";
import { computeNormals, type Point } from "./surface_geometry";

/** From outside, a little from below: a bulge shows against the light. */
export function viewOf(surface: Surface): { focus: Point; direction: Point; up: Point; halfHeight: number } {
  const [low, high]: [Point, Point] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  const normals = new Float32Array(surface.points.length);
  computeNormals(surface.rest, surface.triangles, normals);
  const outward: Point = [0, 0, 0];
  for (let k = 0; k < normals.length; ++k) {
    const c = k % 3;
    outward[c] += normals[k];
    low[c] = Math.min(low[c], surface.rest[k]);
    high[c] = Math.max(high[c], surface.rest[k]);
  }
  const focus = low.map((v, c) => (v + high[c]) / 2) as Point;
  const length = Math.hypot(...outward) || 1;
  const direction = outward.map((v) => v / length) as Point;
  const flat = Math.abs(direction[2]) > 0.99;
  const slanted: Point = flat ? [0, -0.7, 0.714] : direction;
  return {
    focus,
    direction: slanted,
    up: flat ? [0, 0, 1] : [0, 1, 0],
    halfHeight: 0.62 * Math.max(...low.map((v, c) => high[c] - v)),
  };
}
