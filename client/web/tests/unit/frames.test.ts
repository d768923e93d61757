import { create } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";
import { ArraySliceSchema, ArrayType } from "@wire/frame_service_pb";
import { ArrayAssembler, toNumbers, view, type WireArray } from "../../src/api/arrays";
import { meshesOf, trianglesOf } from "../../src/api/meshes";
import type { Frame } from "../../src/api/watch";
import { surfaceObj } from "../../src/run/exports";
import { FrameStore } from "../../src/run/frame_store";
import { MovingSurface } from "../../src/scene/moving_surface";
import { castRay } from "../../src/scene/surface_geometry";

function wire(
  values: Float32Array | Uint16Array | Uint32Array,
  type: ArrayType,
  shape: number[],
  offset = 0,
): WireArray {
  const buffer = new Uint8Array(values.byteLength + offset);
  buffer.set(new Uint8Array(values.buffer), offset);
  return { name: "skin.pressure", unit: "Pa", type, shape, bytes: buffer.subarray(offset), boxMin: [], boxMax: [] };
}

describe("arrays", () => {
  it("are mapped without a copy where they lie on a boundary", () => {
    const array = wire(Float32Array.from([1, 2, 3]), ArrayType.FLOAT32, [3], 8);
    const values = view(array);
    expect([...values]).toEqual([1, 2, 3]);
    expect(values.buffer).toBe(array.bytes.buffer);
  });
  it("are right where they do not", () => {
    expect([...view(wire(Float32Array.from([1, 2, 3]), ArrayType.FLOAT32, [3], 5))]).toEqual([1, 2, 3]);
  });
  it("stand for numbers over a box when they are codes", () => {
    const codes = wire(Uint16Array.from([0, 65535, 32768, 0]), ArrayType.UINT16, [2, 2]);
    const numbers = toNumbers({ ...codes, boxMin: [0, -1], boxMax: [10, 1] });
    expect(numbers[0]).toBe(0);
    expect(numbers[1]).toBe(1);
    expect(numbers[2]).toBeCloseTo(5, 3);
    expect(numbers[3]).toBe(-1);
    expect(() => toNumbers(codes)).toThrow(/box/);
  });
  it("reuse what they are written into", () => {
    const out = new Float32Array(3);
    expect(toNumbers(wire(Float32Array.from([1, 2, 3]), ArrayType.FLOAT32, [3]), out)).toBe(out);
  });
});

describe("pieces", () => {
  const bytes = new Uint8Array(Float32Array.from([1, 2, 3, 4]).buffer);
  const piece = (offset: number, data: Uint8Array, shape = [4n]) =>
    create(ArraySliceSchema, { name: "a", type: ArrayType.FLOAT32, shape, offsetBytes: BigInt(offset), data });
  it("come together in order", () => {
    const assembler = new ArrayAssembler();
    assembler.add(piece(0, bytes.subarray(0, 6)));
    assembler.add(piece(6, bytes.subarray(6)));
    expect([...view(assembler.take().get("a")!)]).toEqual([1, 2, 3, 4]);
  });
  it("are refused out of order, beyond the end, or when one is missing", () => {
    const assembler = new ArrayAssembler();
    expect(() => assembler.add(piece(4, bytes.subarray(4)))).toThrow(/due/);
    const second = new ArrayAssembler();
    second.add(piece(0, bytes.subarray(0, 8)));
    expect(() => second.take()).toThrow(/not complete/);
    expect(() => new ArrayAssembler().add(piece(0, bytes, [4_000_000_000n]))).toThrow(/more than/);
  });
});

describe("meshes", () => {
  const points = { ...wire(new Float32Array(12), ArrayType.FLOAT32, [4, 3]), name: "skin.points" };
  it("of quadrilaterals are drawn as triangles", () => {
    const cells = { ...wire(Uint32Array.from([0, 1, 2, 3]), ArrayType.UINT32, [1, 4]), name: "skin.cells" };
    const mesh = meshesOf(
      new Map([
        [points.name, points],
        [cells.name, cells],
      ]),
    ).get("skin")!;
    expect([...trianglesOf(mesh)]).toEqual([0, 1, 2, 0, 2, 3]);
  });
  it("far from the origin keep their precision, also as they are shown and where a ray meets them", () => {
    // A survey's coordinates, in which single precision would know no less than 32 mm.
    const far = [5e8, -3e8, 1e5];
    const near = [0, 0, 0, 0.25, 0, 0, 0.25, 0.25, 0.0625, 0, 0.25, 0.0625];
    const doubles = Float64Array.from(near, (value, k) => value + far[k % 3]);
    const points = { ...wire(new Float32Array(0), ArrayType.FLOAT64, [4, 3]), name: "skin.points" };
    points.bytes = new Uint8Array(doubles.buffer);
    const cells = { ...wire(Uint32Array.from([0, 1, 2, 3]), ArrayType.UINT32, [1, 4]), name: "skin.cells" };
    const mesh = meshesOf(
      new Map([
        [points.name, points],
        [cells.name, cells],
      ]),
    ).get("skin")!;
    const scene = { add: () => undefined, remove: () => undefined };
    const face = new MovingSurface(mesh, scene);
    const lifted = Float32Array.from([0, 0, 0, 0, 0, 1 / 32, 0, 0, 1 / 32, 0, 0, 0]);
    face.move(lifted);
    expect(Array.from(face.points, (value, k) => value - far[k % 3])).toEqual(
      near.map((value, k) => value + lifted[k]),
    );
    const { normals } = new MovingSurface({ ...mesh, points: Float32Array.from(near) }, scene);
    face.move();
    face.normals.forEach((value, k) => expect(value).toBeCloseTo(normals[k], 5));
    const hit = castRay(mesh.points, trianglesOf(mesh), [far[0] + 0.2, far[1] + 0.1, far[2] + 9], [0, 0, -1])!;
    expect(hit.point[2] - far[2]).toBeCloseTo(0.025, 6);
    expect(surfaceObj(face.points, mesh.cells, 4)).toContain("v 500000000.2500 -299999999.7500 100000.0625");
  });
  it("of a scan have its colours, and as many as they have points", () => {
    const cells = { ...wire(Uint32Array.from([0, 1, 2]), ArrayType.UINT32, [1, 3]), name: "skin.cells" };
    const colourOf = (n: number): Map<string, WireArray> => {
      const bytes = Uint8Array.from({ length: 3 * n }, (_, k) => 10 * k);
      const colour = { ...points, name: "skin.colour", type: ArrayType.UINT8, shape: [n, 3], bytes };
      return new Map([points, cells, colour].map((array) => [array.name, array]));
    };
    const count = points.shape[0];
    expect(meshesOf(colourOf(count)).get("skin")!.colours![4]).toBe(40);
    expect(() => meshesOf(colourOf(count + 1))).toThrow(/colours for/);
  });
  it("with a cell beyond their points are refused", () => {
    const cells = { ...wire(Uint32Array.from([0, 1, 4]), ArrayType.UINT32, [1, 3]), name: "skin.cells" };
    expect(() =>
      meshesOf(
        new Map([
          [points.name, points],
          [cells.name, cells],
        ]),
      ),
    ).toThrow(/has not/);
  });
});

describe("the frames of a run", () => {
  const frame = (step: number, bytes = 1000): Frame => ({
    epoch: 1n,
    sequence: BigInt(step),
    timeS: step * 0.01,
    preview: false,
    end: false,
    fields: new Map([["scan.displacement", wire(new Float32Array(bytes / 4), ArrayType.FLOAT32, [bytes / 4])]]),
  });
  it("stay within their bound, over the whole time, with the newest", () => {
    const store = new FrameStore(20_000);
    for (let step = 0; step <= 1000; ++step) {
      store.add(frame(step));
      expect(store.sizeBytes).toBeLessThanOrEqual(20_000);
    }
    expect(store.frames[0].sequence).toBe(0n);
    expect(store.latest!.sequence).toBe(1000n);
    expect(store.frames.at(-1)).toBe(store.latest);
    const gaps = store.frames.slice(1).map((f, k) => Number(f.sequence - store.frames[k].sequence));
    expect(Math.max(...gaps)).toBeLessThanOrEqual(130);
  });
  it("are found by time", () => {
    const store = new FrameStore();
    for (let step = 0; step <= 10; ++step) store.add(frame(step));
    expect(store.at(0.055)!.sequence).toBe(5n);
    expect(store.at(-1)!.sequence).toBe(0n);
    expect(store.at(99)!.sequence).toBe(10n);
  });
  it("take one of an earlier moment, and the newest stays", () => {
    const store = new FrameStore();
    store.insert(frame(4));
    expect(store.latest!.sequence).toBe(4n);
    store.add(frame(9));
    store.insert(frame(2));
    store.insert(frame(4));
    expect(store.frames.map(({ sequence }) => Number(sequence))).toEqual([2, 4, 9]);
    expect(store.latest!.sequence).toBe(9n);
    expect(store.at(0.05)!.sequence).toBe(4n);
  });
  it("after a return to an earlier state are dropped", () => {
    const store = new FrameStore();
    for (let step = 0; step <= 10; ++step) store.add(frame(step));
    store.dropAfter(4n);
    expect(store.latest!.sequence).toBe(4n);
  });
});
