import { describe, expect, it } from "vitest";
import { bandOf, mapFor, mmHgPerPa, paint, pressureBands, roundUp } from "../../src/scene/colour_maps";
import { castRay, computeNormals, valueAt } from "../../src/scene/surface_geometry";
import { outerFaces } from "../../src/scene/layers";

describe("pressure bands", () => {
  it("begin at 9, 15 and 30 mmHg", () => {
    expect([0, 8.99, 9, 14.99, 15, 29.9, 30, 200].map(bandOf)).toEqual([0, 0, 1, 1, 2, 2, 3, 3]);
    expect(1200 * mmHgPerPa).toBeCloseTo(9.0, 2);
  });
  it("are on the map as they are on the skin", () => {
    const map = mapFor("pressure", 12);
    const out = new Uint8Array(3);
    paint(map, 12, out, 0);
    expect([...out]).toEqual(pressureBands[1].colour);
  });
  it("grow darker, for those who do not see their hue", () => {
    const lightness = pressureBands.map(({ colour: [r, g, b] }) => 0.2126 * r + 0.7152 * g + 0.0722 * b);
    expect(lightness[1]).toBeGreaterThan(lightness[2]);
    expect(lightness[2]).toBeGreaterThan(lightness[3] + 30);
  });
});

describe("colour maps", () => {
  it("end at round numbers", () => {
    expect([0.04, 1.2, 4.6, 31, 0].map(roundUp)).toEqual([0.04, 1.5, 5, 40, 1]);
  });
  it("hold distances about zero", () => {
    const map = mapFor("distance", 4.2);
    expect([map.low, map.high]).toEqual([-5, 5]);
  });
  it("take what lies beyond by their ends", () => {
    const map = mapFor("displacement", 5);
    const out = new Uint8Array(6);
    paint(map, 99, out, 0);
    paint(map, 5, out, 3);
    expect([...out.subarray(0, 3)]).toEqual([...out.subarray(3)]);
  });
});

describe("a surface", () => {
  const points = Float32Array.from([0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, -1, 2, 0, -1, 0, 2, -1]);
  const triangles = Uint32Array.from([0, 1, 2, 3, 4, 5]);
  it("has unit normals", () => {
    const normals = new Float32Array(points.length);
    computeNormals(points, triangles, normals);
    expect([...normals.subarray(0, 3)]).toEqual([0, 0, 1]);
  });
  it("is met at its front", () => {
    const hit = castRay(points, triangles, [0.5, 0.5, 5], [0, 0, -1])!;
    expect(hit.triangle).toBe(0);
    expect(hit.distance).toBeCloseTo(5);
    expect(valueAt([0, 4, 8, 0, 0, 0], triangles, hit)).toBeCloseTo(3);
    expect(castRay(points, triangles, [3, 3, 5], [0, 0, -1])).toBeUndefined();
  });
});

describe("a layer", () => {
  it("shows the faces that two hexahedra do not share", () => {
    const cells = Uint32Array.from([0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 9, 10, 11]);
    expect(outerFaces(cells)).toHaveLength(10 * 4);
  });
});
