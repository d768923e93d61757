// Guessed landmarks, against those that were set on faces of other origins; and sides that are
// taken for each other.
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import type { Vector3 } from "@wire/geometry_pb";
import { describe, expect, it } from "vitest";
import { guessLandmarks } from "../../src/landmarks/guess";
import { swap, swappedPairs } from "../../src/landmarks/swapped";
import { vectorOf } from "../../src/plan/landmarks";
import type { Point } from "../../src/scene/surface_geometry";

const root = fileURLToPath(new URL("../../../../", import.meta.url));
const faces = join(root, "../shared/data/faces");
type Landmarks = Record<string, Point>;
const landmarksOf = (path: string): Landmarks =>
  (JSON.parse(readFileSync(path, "utf8")) as { landmarks: Landmarks }).landmarks;

/** A binary PLY of three floats a vertex, and triangles or larger polygons. */
function readPly(path: string): { points: Float32Array; triangles: Uint32Array } {
  const bytes = readFileSync(path);
  const body = bytes.indexOf("end_header\n") + "end_header\n".length;
  const head = bytes.subarray(0, body).toString();
  const [vertices, polygons] = ["vertex", "face"].map((name) =>
    Number(new RegExp(`element ${name} (\\d+)`).exec(head)![1]),
  );
  const points = Float32Array.from({ length: 3 * vertices }, (_, k) => bytes.readFloatLE(body + 4 * k));
  const triangles: number[] = [];
  for (let polygon = 0, at = body + 12 * vertices; polygon < polygons; ++polygon) {
    const count = bytes[at];
    const corners = Array.from({ length: count }, (_, k) => bytes.readInt32LE(at + 1 + 4 * k));
    for (let k = 2; k < count; ++k) triangles.push(corners[0], corners[k - 1], corners[k]);
    at += 1 + 4 * count;
  }
  return { points, triangles: Uint32Array.from(triangles) };
}

/** Lets others run: a test that holds the thread is taken for dead. */
const breath = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 5));
const median = (values: number[]): number => [...values].sort((a, b) => a - b)[values.length >> 1];
const apart = (a: Point, b: Point): number => Math.hypot(...a.map((v, c) => v - b[c]));

/** The face in other axes, as programs have them, and some ten degrees off those. */
const turnedPoint = ([x, y, z]: Point): Point => {
  const [c, s] = [Math.cos(0.2), Math.sin(0.2)];
  const [across, deep] = [c * y - s * z, s * y + c * z];
  return [300 - s * x + c * deep, c * x + s * deep, across - 50];
};
const turned = (points: ArrayLike<number>): Float32Array => {
  const out = new Float32Array(points.length);
  for (let k = 0; k < points.length; k += 3) out.set(turnedPoint([points[k], points[k + 1], points[k + 2]]), k);
  return out;
};

describe.skipIf(!existsSync(faces))("guesses on the faces beside the project (skipped: ../shared is not there)", () => {
  it("lie within 4 mm of landmarks set by hand, in the median, and say how far they may be off", async () => {
    const off: number[] = [];
    const by = new Map<string, number[]>();
    for (const file of readdirSync(faces).filter((name) => name.endsWith(".ply"))) {
      const { points, triangles } = readPly(join(faces, file));
      await breath();
      const found = guessLandmarks(points, triangles);
      expect(found, file).toBeDefined();
      for (const [name, at] of Object.entries(landmarksOf(join(faces, file.replace(".ply", ".landmarks.json"))))) {
        const guess = found!.points[name];
        expect(guess, `${file} ${name}`).toBeDefined();
        off.push(apart(at, guess.at));
        const kind = name.replace(/_(left|right)$/, "");
        by.set(kind, [...(by.get(kind) ?? []), apart(at, guess.at)]);
      }
    }
    for (const [kind, all] of by)
      console.log(`${kind}: median ${median(all).toFixed(1)} mm, worst ${Math.max(...all).toFixed(1)} mm`);
    console.log(`median of ${off.length} guesses: ${median(off).toFixed(2)} mm`);
    expect(median(off)).toBeLessThanOrEqual(4);
  }, 300_000);

  it("hardly depend on how the face lies", () => {
    const { points, triangles } = readPly(join(faces, "mask_03.ply"));
    const plain = guessLandmarks(points, triangles)!.points;
    const found = guessLandmarks(turned(points), triangles)!.points;
    const names = Object.keys(plain).filter((name) => found[name]);
    expect(names.length).toBeGreaterThan(8);
    const off = names.map((name) => apart(turnedPoint(plain[name].at), found[name].at));
    expect(median(off)).toBeLessThan(5);
  }, 300_000);
});

describe("a surface without a face", () => {
  it("gets no guess", () => {
    const points = Float32Array.from(
      Array.from({ length: 400 }, (_, k) => [5 * (k % 20), 5 * Math.floor(k / 20), 0]).flat(),
    );
    const triangles = Uint32Array.from(
      Array.from({ length: 360 }, (_, k) => (k % 20 === 19 ? [] : [k, k + 1, k + 20])).flat(),
    );
    expect(guessLandmarks(points, triangles)).toBeUndefined();
  });
});

describe("left and right", () => {
  const set = (): Record<string, Vector3> =>
    Object.fromEntries(
      Object.entries({
        nasion: [0, 40, 100],
        pronasale: [0, 5, 125],
        subnasale: [0, -12, 112],
        exocanthion_left: [44, 34, 86],
        exocanthion_right: [-44, 34, 86],
        cheilion_left: [25, -35, 100],
        cheilion_right: [-25, -35, 100],
      }).map(([name, at]) => [name, vectorOf(at)]),
    );
  it("are as they should be", () => expect(swappedPairs(set())).toEqual([]));
  it("are seen to be swapped, by pair, and put right", () => {
    const points = set();
    swap(points, ["cheilion"]);
    expect(swappedPairs(points)).toEqual(["cheilion"]);
    swap(points, ["exocanthion"]);
    expect(swappedPairs(points).sort()).toEqual(["cheilion", "exocanthion"]);
    swap(points, swappedPairs(points));
    expect(points).toEqual(set());
  });
  it("are not judged without the middle of the face", () => {
    const points = set();
    swap(points, ["cheilion"]);
    delete points.pronasale;
    expect(swappedPairs(points)).toEqual([]);
  });
});
