// Meshes as the scene draws them: points and triangles.
import type { MeshSlice } from "@wire/frame_service_pb";
import { ArrayAssembler, view, type WireArray } from "./arrays";

/** Numbers of points: in double precision where they lie far from the origin. */
export type Coordinates = Float32Array | Float64Array;

export interface Mesh {
  name: string;
  /** [mm] (3 n) */
  points: Coordinates;
  /** (corners n) indices into the points */
  cells: Uint32Array;
  /** of a cell: 3, 4 or 8 */
  corners: number;
  /** red, green and blue of a scan's points, as it was taken (3 n); absent: it has none */
  colours?: Uint8Array;
}

/** As many numbers as a mesh of some points needs for other points near them. */
export const likeThese = (points: Coordinates, length: number): Coordinates =>
  points instanceof Float64Array ? new Float64Array(length) : new Float32Array(length);

/**
 * Points far from the origin come in double precision and keep it: the toolkit moves them to the
 * origin when it sends them to the graphics card, which has single precision.
 */
function pointsOf(array: WireArray): Coordinates {
  const values = view(array);
  return values instanceof Float32Array || values instanceof Float64Array ? values : Float32Array.from(values);
}

export function meshesOf(arrays: Map<string, WireArray>): Map<string, Mesh> {
  const meshes = new Map<string, Mesh>();
  for (const [key, points] of arrays) {
    if (!key.endsWith(".points")) continue;
    const name = key.slice(0, -".points".length);
    const cells = arrays.get(`${name}.cells`);
    if (cells === undefined) throw new Error(`the mesh ${name} has points but no cells`);
    const mesh = {
      name,
      points: pointsOf(points),
      cells: view(cells) as Uint32Array,
      corners: cells.shape[1],
    };
    const n = mesh.points.length / 3;
    if (mesh.cells.some((index) => index >= n)) throw new Error(`the mesh ${name} has a cell with a point it has not`);
    const colours = arrays.get(`${name}.colour`);
    if (colours !== undefined && colours.shape[0] !== n)
      throw new Error(`the mesh ${name} has ${colours.shape[0]} colours for ${n} points`);
    meshes.set(name, colours === undefined ? mesh : { ...mesh, colours: view(colours) as Uint8Array });
  }
  return meshes;
}

export async function collectMeshes(stream: AsyncIterable<MeshSlice>): Promise<Map<string, Mesh>> {
  const assembler = new ArrayAssembler();
  for await (const slice of stream) slice.arrays.forEach((array) => assembler.add(array));
  return meshesOf(assembler.take());
}

/** Two triangles for a quadrilateral, the cells themselves for triangles. */
export function trianglesOf(mesh: Mesh): Uint32Array {
  if (mesh.corners === 3) return mesh.cells;
  if (mesh.corners !== 4) throw new Error(`${mesh.name} has cells of ${mesh.corners} corners`);
  const triangles = new Uint32Array((mesh.cells.length / 4) * 6);
  for (let q = 0, t = 0; q < mesh.cells.length; q += 4) {
    const [a, b, c, d] = mesh.cells.subarray(q, q + 4);
    triangles.set([a, b, c, a, c, d], t);
    t += 6;
  }
  return triangles;
}
