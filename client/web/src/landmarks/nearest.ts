// The vertex of a surface that is nearest to a point, by a grid of cells.
import type { Point } from "../scene/surface_geometry";

const cellMm = 6;
/** Beyond so many cells nothing is near. */
const mostRings = 3;

export class NearestVertex {
  private readonly cells = new Map<number, number[]>();

  constructor(private readonly points: ArrayLike<number>) {
    for (let k = 0; k < points.length; k += 3) {
      const key = keyOf(cellOf(points[k]), cellOf(points[k + 1]), cellOf(points[k + 2]));
      const cell = this.cells.get(key);
      if (cell) cell.push(k);
      else this.cells.set(key, [k]);
    }
  }

  /** Its number and how far it is [mm]; undefined where none is within some 18 mm. */
  find(at: Point): { vertex: number; apart: number } | undefined {
    const [x, y, z] = at.map(cellOf);
    let [vertex, least] = [-1, Infinity];
    for (let ring = 0; ring <= mostRings; ++ring) {
      if (vertex >= 0 && Math.sqrt(least) < (ring - 1) * cellMm) break;
      for (let i = -ring; i <= ring; ++i)
        for (let j = -ring; j <= ring; ++j)
          for (let k = -ring; k <= ring; ++k) {
            if (Math.max(Math.abs(i), Math.abs(j), Math.abs(k)) !== ring) continue;
            for (const at3 of this.cells.get(keyOf(x + i, y + j, z + k)) ?? []) {
              const p = this.points;
              const d = (p[at3] - at[0]) ** 2 + (p[at3 + 1] - at[1]) ** 2 + (p[at3 + 2] - at[2]) ** 2;
              if (d < least) [vertex, least] = [at3 / 3, d];
            }
          }
    }
    return vertex < 0 ? undefined : { vertex, apart: Math.sqrt(least) };
  }
}

const cellOf = (v: number): number => Math.floor(v / cellMm);
const keyOf = (x: number, y: number, z: number): number => (x + 32768) * 4294967296 + (y + 32768) * 65536 + (z + 32768);
