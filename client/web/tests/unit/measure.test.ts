// Rulers and sections, on surfaces whose lengths are known.
import { describe, expect, it } from "vitest";
import { alongSkin, angleAt, placeNear, pointAt } from "../../src/scene/measure";
import { cutSection } from "../../src/scene/section";
import type { Point } from "../../src/scene/surface_geometry";

/** A cylinder of triangles about the z axis, open at its ends and over its last quarter. */
function cylinder(radius: number, around = 96, rows = 40) {
  const points: number[] = [];
  const triangles: number[] = [];
  const last = (3 / 4) * around;
  for (let j = 0; j <= rows; ++j)
    for (let k = 0; k <= last; ++k) {
      const angle = (2 * Math.PI * k) / around;
      points.push(radius * Math.cos(angle), radius * Math.sin(angle), j);
    }
  const at = (j: number, k: number): number => j * (last + 1) + k;
  for (let j = 0; j < rows; ++j)
    for (let k = 0; k < last; ++k)
      triangles.push(at(j, k), at(j, k + 1), at(j + 1, k + 1), at(j, k), at(j + 1, k + 1), at(j + 1, k));
  return { points: Float32Array.from(points), triangles: Uint32Array.from(triangles) };
}

describe("a ruler", () => {
  const { points, triangles } = cylinder(30);
  const on = (angle: number, z: number): Point => [30 * Math.cos(angle), 30 * Math.sin(angle), z];
  const place = (angle: number, z: number) => placeNear(points, triangles, on(angle, z));

  it("keeps a place on the skin", () => {
    const at = pointAt(points, triangles, place(0.7, 12.3));
    on(0.7, 12.3).forEach((v, c) => expect(at[c]).toBeCloseTo(v, 1));
  });
  it("goes along the skin around a cylinder, as long as its arc", () => {
    const found = alongSkin(points, triangles, place(0.3, 12.3), place(2.1, 12.3))!;
    expect(found.lengthMm / (30 * 1.8)).toBeCloseTo(1, 3);
    expect(found.lengthMm).toBeGreaterThan(2 * 30 * Math.sin(0.9) + 5);
  });
  it("goes straight along a cylinder", () => {
    expect(alongSkin(points, triangles, place(0.5, 3), place(0.5, 36))!.lengthMm).toBeCloseTo(33, 1);
  });
  it("finds no way over a gap", () => {
    const [from, to] = [place(0.1, 20), place((3 / 2) * Math.PI - 0.1, 20)];
    const found = alongSkin(points, triangles, from, to);
    // The short way leads over the gap: what is left goes around.
    expect(found === undefined || found.lengthMm > 30 * Math.PI).toBe(true);
    expect(alongSkin(points, triangles.slice(0, 3), { triangle: 0, weights: [1, 0, 0] }, from)).toBeUndefined();
  });
  it("takes angles", () => {
    expect(angleAt([1, 0, 0], [0, 0, 0], [0, 2, 0])).toBeCloseTo(90);
    expect(angleAt([1, 0, 0], [0, 0, 0], [-3, 0, 0])).toBeCloseTo(180);
  });
});

describe("a section", () => {
  /** Two layers of 2 by 3 blocks of 10 mm, 2 mm and 4 mm thick; the skin lies at z = 0. */
  function blocks(gap: (i: number, j: number) => number) {
    const [nXi, nEta] = [2, 3];
    const points: number[] = [];
    const cells: number[] = [];
    const node = (level: number, i: number, j: number): number => level * 12 + j * 3 + i;
    // The deep face of the first layer and the outer one of the second have nodes of their own.
    for (const [z, lifted] of [
      [0, true],
      [-2, true],
      [-2, false],
      [-6, false],
    ] as const)
      for (let j = 0; j <= nEta; ++j)
        for (let i = 0; i <= nXi; ++i) points.push(10 * i, 10 * j, z + (lifted ? gap(i, j) : 0));
    for (const [outer, deep] of [
      [0, 1],
      [2, 3],
    ])
      for (let j = 0; j < nEta; ++j)
        for (let i = 0; i < nXi; ++i)
          for (const level of [deep, outer])
            cells.push(node(level, i, j), node(level, i + 1, j), node(level, i + 1, j + 1), node(level, i, j + 1));
    return { points: Float32Array.from(points), cells: Uint32Array.from(cells) };
  }
  const grid = { nXi: 2, nEta: 3, elementsThrough: [1, 1] };
  const rest = blocks(() => 0);

  it("has the fat between two layers, as thick as their gap", () => {
    const lifted = blocks((i, j) => (i === 1 && j === 1 ? 3 : 0));
    const cut = cutSection(lifted.cells, lifted.points, rest.points, grid, { across: "xi", index: 1 }, false);
    expect(cut.width).toBeCloseTo(20);
    expect([cut.low, cut.high]).toEqual([-6, 3]);
    expect(cut.fat).toHaveLength(1);
    expect(cut.fat[0].layer).toBe(0);
    expect(cut.fat[0].thickest).toBeCloseTo(3);
    expect(cut.fat[0].area).toBeCloseTo(30);
    expect(cut.skin).toEqual([
      [0, 10, 0],
      [10, 10, 3],
      [20, 10, 0],
    ]);
  });
  it("goes the other way, to the last row, and has no fat where there is none", () => {
    const lifted = blocks((i, j) => (i === 1 && j === 1 ? 3 : 0));
    const cut = cutSection(lifted.cells, lifted.points, rest.points, grid, { across: "eta", index: 2 }, false);
    expect(cut.width).toBeCloseTo(30);
    expect(cut.fat).toEqual([]);
    expect(cut.skin.map(([x]) => x)).toEqual([20, 20, 20, 20]);
  });
  it("has fat below the last layer over what does not move", () => {
    const lifted = rest.points.map((v, k) => (k % 3 === 2 ? v + 1 : v));
    const row = { across: "xi", index: 0 } as const;
    expect(cutSection(rest.cells, lifted, rest.points, grid, row, false).fat).toEqual([]);
    const [fat] = cutSection(rest.cells, lifted, rest.points, grid, row, true).fat;
    expect([fat.layer, fat.thickest, fat.area]).toEqual([1, 1, 20]);
  });
});
