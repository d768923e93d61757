// A section through the model: its layers and the fat between them along a row of its grid.
import type { Coordinates } from "../api/meshes";
import type { Point } from "./surface_geometry";

export interface Grid {
  nXi: number;
  nEta: number;
  /** of each layer, from the skin inwards */
  elementsThrough: number[];
}

/** A row of the grid: all columns at one place along xi, or along eta. */
export interface Row {
  across: "xi" | "eta";
  index: number;
}

type Flat = [number, number];

export interface SectionFat {
  /** the layer above it */
  layer: number;
  outline: Flat[];
  /** [mm] */
  thickest: number;
  /** [mm2] */
  area: number;
}

export interface Section {
  /** of each layer, around it [mm], upwards out of the face */
  layers: Flat[][];
  fat: SectionFat[];
  /** the row on the skin [mm] */
  skin: Point[];
  width: number;
  low: number;
  high: number;
}

/** Thinner than this is the film that wets a plane [mm]. */
const wet = 0.12;

/** Nodes of a row, from its begin to its end, on the outer and the deep face of each layer. */
function edgesOf(cells: Uint32Array, grid: Grid, { across, index }: Row): { outer: number[]; deep: number[] }[] {
  const { nXi, nEta } = grid;
  const [length, most] = across === "xi" ? [nXi, nEta] : [nEta, nXi];
  // Beyond the last cell lies the far side of that cell.
  const [line, far] = index === most ? [most - 1, true] : [index, false];
  const cellAt = (level: number, k: number): number =>
    8 * (level * nXi * nEta + (across === "xi" ? line * nXi + k : k * nXi + line));
  // Corners of a hexahedron: its deep face first, anticlockwise from (xi, eta).
  const [first, last] = across === "xi" ? (far ? [3, 2] : [0, 1]) : far ? [1, 2] : [0, 3];
  let level = 0;
  return grid.elementsThrough.map((count) => {
    const [top, bottom] = [level, level + count - 1];
    level += count;
    const along = (l: number, face: number): number[] => [
      ...Array.from({ length }, (_, k) => cells[cellAt(l, k) + face + first]),
      cells[cellAt(l, length - 1) + face + last],
    ];
    return { outer: along(top, 4), deep: along(bottom, 0) };
  });
}

const area = (outline: Flat[]): number =>
  Math.abs(
    outline.reduce((sum, [x, y], k) => {
      const [p, q] = outline[(k + 1) % outline.length];
      return sum + x * q - p * y;
    }, 0) / 2,
  );

/**
 * @param cells  hexahedra in rows of xi, then eta, then levels from the skin inwards
 * @param points  as they are [mm] (3 n)
 * @param rest  at rest, for fat below the last layer, whose other side does not move
 */
export function cutSection(
  cells: Uint32Array,
  points: Coordinates,
  rest: Coordinates,
  grid: Grid,
  row: Row,
  fatBelowLast: boolean,
): Section {
  const edges = edgesOf(cells, grid, row);
  const at = (of: Coordinates, node: number): Point => [of[3 * node], of[3 * node + 1], of[3 * node + 2]];
  const skin = edges[0].outer.map((node) => at(points, node));
  const deepest = edges[edges.length - 1].deep;
  const restSkin = edges[0].outer.map((node) => at(rest, node));
  const [begin, end] = [restSkin[0], restSkin[restSkin.length - 1]];
  const unit = (v: Point): Point => v.map((x) => x / (Math.hypot(...v) || 1)) as Point;
  const along = unit(end.map((v, c) => v - begin[c]) as Point);
  // Upwards is out of the face: from the deepest nodes to the skin, upright on the row.
  const outward: Point = [0, 0, 0];
  deepest.forEach((node, k) => at(rest, node).forEach((v, c) => (outward[c] += restSkin[k][c] - v)));
  const slant = outward.reduce((sum, v, c) => sum + v * along[c], 0);
  const up = unit(outward.map((v, c) => v - slant * along[c]) as Point);
  const flat = (p: Point): Flat => {
    const v = p.map((x, c) => x - begin[c]);
    return [v.reduce((s, x, c) => s + x * along[c], 0), v.reduce((s, x, c) => s + x * up[c], 0)];
  };
  const line = (nodes: number[], of = points): Flat[] => nodes.map((node) => flat(at(of, node)));
  const layers = edges.map(({ outer, deep }) => [...line(outer), ...line(deep).reverse()]);
  const fat = edges.flatMap(({ deep }, layer): SectionFat[] => {
    const isLast = layer === edges.length - 1;
    if (isLast && !fatBelowLast) return [];
    const below = isLast ? line(deep, rest) : line(edges[layer + 1].outer);
    const above = line(deep);
    const gaps = above.map(([x, y], k) => Math.hypot(x - below[k][0], y - below[k][1]));
    const thickest = Math.max(...gaps);
    if (thickest < wet) return [];
    const outline = [...above, ...below.reverse()];
    return [{ layer, outline, thickest, area: area(outline) }];
  });
  const all = [...layers, ...fat.map(({ outline }) => outline)].flat();
  const [low, high] = [Math.min(...all.map(([, y]) => y)), Math.max(...all.map(([, y]) => y))];
  return { layers, fat, skin, low, high, width: Math.max(...all.map(([x]) => x)) };
}
