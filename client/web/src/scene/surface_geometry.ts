// What follows from the points of a surface: normals, where a ray meets it, which vertices
// neighbour which.
export type Point = [number, number, number];

/** Unit normals of the vertices, by area, written into `out`. */
export function computeNormals(points: ArrayLike<number>, triangles: Uint32Array, out: Float32Array): void {
  out.fill(0);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const ux = points[b] - points[a],
      uy = points[b + 1] - points[a + 1],
      uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a],
      vy = points[c + 1] - points[a + 1],
      vz = points[c + 2] - points[a + 2];
    const nx = uy * vz - uz * vy,
      ny = uz * vx - ux * vz,
      nz = ux * vy - uy * vx;
    out[a] += nx;
    out[a + 1] += ny;
    out[a + 2] += nz;
    out[b] += nx;
    out[b + 1] += ny;
    out[b + 2] += nz;
    out[c] += nx;
    out[c + 1] += ny;
    out[c + 2] += nz;
  }
  for (let i = 0; i < out.length; i += 3) {
    const length = Math.sqrt(out[i] * out[i] + out[i + 1] * out[i + 1] + out[i + 2] * out[i + 2]) || 1;
    out[i] /= length;
    out[i + 1] /= length;
    out[i + 2] /= length;
  }
}

export interface Hit {
  /** first of the triangle's three places in the list of corners */
  triangle: number;
  /** of its corners, sum 1 */
  weights: Point;
  point: Point;
  distance: number;
}

/** The first triangle a ray meets (Moeller and Trumbore), from either side. */
export function castRay(points: ArrayLike<number>, triangles: Uint32Array, from: Point, along: Point): Hit | undefined {
  let best: Hit | undefined;
  const [dx, dy, dz] = along;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t],
      b = 3 * triangles[t + 1],
      c = 3 * triangles[t + 2];
    const ux = points[b] - points[a],
      uy = points[b + 1] - points[a + 1],
      uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a],
      vy = points[c + 1] - points[a + 1],
      vz = points[c + 2] - points[a + 2];
    const px = dy * vz - dz * vy,
      py = dz * vx - dx * vz,
      pz = dx * vy - dy * vx;
    const determinant = ux * px + uy * py + uz * pz;
    if (Math.abs(determinant) < 1e-12) continue;
    const sx = from[0] - points[a],
      sy = from[1] - points[a + 1],
      sz = from[2] - points[a + 2];
    const u = (sx * px + sy * py + sz * pz) / determinant;
    if (u < 0 || u > 1) continue;
    const qx = sy * uz - sz * uy,
      qy = sz * ux - sx * uz,
      qz = sx * uy - sy * ux;
    const v = (dx * qx + dy * qy + dz * qz) / determinant;
    if (v < 0 || u + v > 1) continue;
    const distance = (vx * qx + vy * qy + vz * qz) / determinant;
    if (distance <= 0 || (best !== undefined && distance >= best.distance)) continue;
    best = {
      triangle: t,
      weights: [1 - u - v, u, v],
      distance,
      point: [from[0] + distance * dx, from[1] + distance * dy, from[2] + distance * dz],
    };
  }
  return best;
}

export function distanceOf(a: ArrayLike<number>, b: ArrayLike<number>): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/** The value at a hit, linear between the corners. */
export function valueAt(values: ArrayLike<number>, triangles: Uint32Array, hit: Hit): number {
  return hit.weights.reduce((sum, weight, k) => sum + weight * values[triangles[hit.triangle + k]], 0);
}
