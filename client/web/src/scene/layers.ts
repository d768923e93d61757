// The layers of tissue as blocks: the outer faces of each layer's hexahedra.
import { likeThese, type Coordinates, type Mesh } from "../api/meshes";
import type { Rgb } from "./colour_maps";
import { Surface } from "./surface";

/** Corner numbers of a hexahedron's six faces, deep face first. */
const faces = [
  [0, 3, 2, 1],
  [4, 5, 6, 7],
  [0, 1, 5, 4],
  [1, 2, 6, 5],
  [2, 3, 7, 6],
  [3, 0, 4, 7],
];

export const layerColours: Rgb[] = [
  [224, 176, 150],
  [240, 214, 120],
  [196, 150, 170],
  [170, 70, 66],
  [120, 110, 150],
];

/** Faces that only one of the hexahedra has, as quadrilaterals. */
export function outerFaces(cells: Uint32Array): Uint32Array {
  const seen = new Map<string, number[] | null>();
  for (let h = 0; h < cells.length; h += 8) {
    for (const face of faces) {
      const quad = face.map((corner) => cells[h + corner]);
      const key = [...quad].sort((a, b) => a - b).join();
      seen.set(key, seen.has(key) ? null : quad);
    }
  }
  return Uint32Array.from([...seen.values()].flatMap((quad) => quad ?? []));
}

/** @param elementsThrough of each layer, from the skin inwards */
export function makeLayers(tissue: Mesh, elementsThrough: number[]): Surface[] {
  const levels = elementsThrough.reduce((sum, n) => sum + n, 0);
  const perLevel = tissue.cells.length / 8 / levels;
  let level = 0;
  return elementsThrough.map((n, index) => {
    const cells = tissue.cells.subarray(level * perLevel * 8, (level + n) * perLevel * 8);
    level += n;
    return compact(tissue.points, outerFaces(cells), layerColours[index % layerColours.length]);
  });
}

/** A surface of only those points that its quadrilaterals use. */
function compact(points: Coordinates, quads: Uint32Array, colour: Rgb): Surface {
  const number = new Map<number, number>();
  const used: number[] = [];
  const cells = quads.map((index) => {
    let k = number.get(index);
    if (k === undefined) {
      k = number.size;
      number.set(index, k);
      used.push(points[3 * index], points[3 * index + 1], points[3 * index + 2]);
    }
    return k;
  });
  const near = likeThese(points, used.length);
  near.set(used);
  const mesh: Mesh = { name: "layer", points: near, cells, corners: 4 };
  return new Surface(mesh, colour);
}
