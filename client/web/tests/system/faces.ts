// Faces that tests make of the synthetic one: with something missing, moved, or of somebody else.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { root } from "./system";

type Point = [number, number, number];

export const halfFace = join(root, "client/examples/faces/half_face.obj");
export const halfFaceLandmarks = join(root, "client/examples/faces/half_face.landmarks.json");

interface Landmarks {
  landmarks: Record<string, Point>;
  [other: string]: unknown;
}
const landmarksOf = (path: string): Landmarks => JSON.parse(readFileSync(path, "utf8")) as Landmarks;

function read(path: string): { points: Point[]; rest: string[]; triangles: Point[] } {
  const lines = readFileSync(path, "utf8").split("\n");
  const numbers = (line: string): number[] =>
    line
      .trim()
      .split(/\s+/)
      .slice(1)
      .map((word) => parseFloat(word));
  const points = lines.filter((line) => line.startsWith("v ")).map((line) => numbers(line) as Point);
  const rest = lines.filter((line) => !line.startsWith("v ") && !line.startsWith("vn "));
  const cells = rest.filter((line) => line.startsWith("f ")).map((line) => numbers(line).map((v) => v - 1));
  const triangles = cells.flatMap((cell) => cell.slice(2).map((_, k) => [cell[0], cell[k + 1], cell[k + 2]] as Point));
  return { points, rest, triangles };
}

/** Six times the signed volume under the triangles, from the origin. */
const volumeMl = (points: Point[], triangles: Point[]): number =>
  triangles.reduce((sum, [i, j, k]) => {
    const [a, b, c] = [points[i], points[j], points[k]];
    const cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
    return sum + a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2];
  }, 0) / 6000;

/** The synthetic face sunk over its left masseter by at most `depth` mm; what is missing then. */
export function sunkFace(path: string, depth: number): { missingMl: number } {
  const { points, rest, triangles } = read(halfFace);
  const { landmarks } = landmarksOf(halfFaceLandmarks);
  const mix = (k: number): number =>
    0.45 * landmarks.zygion_left[k] + 0.45 * landmarks.gonion_left[k] + 0.1 * landmarks.cheilion_left[k];
  const centre = points.reduce((best, point) => {
    const off = (at: Point): number => Math.hypot(...at.map((v, k) => v - mix(k)));
    return off(point) < off(best) ? point : best;
  });
  const sunk = points.map((point) => {
    const away = Math.hypot(...point.map((v, k) => v - centre[k])) / 32;
    const weight = away < 1 ? (1 - away * away) ** 2 : 0;
    return [point[0] - depth * weight, point[1], point[2]] as Point;
  });
  writeFileSync(path, [...sunk.map((point) => `v ${point.map((v) => v.toFixed(5)).join(" ")}`), ...rest].join("\n"));
  return { missingMl: Math.abs(volumeMl(points, triangles) - volumeMl(sunk, triangles)) };
}

/** Another person: the synthetic face, larger and elsewhere, with landmarks of its own. */
export function otherFace(scan: string, landmarksFile: string): void {
  const move = (point: Point): Point => point.map((v) => 1.06 * v + 20) as Point;
  const { points, rest } = read(halfFace);
  writeFileSync(
    scan,
    [
      ...points.map(
        (point) =>
          `v ${move(point)
            .map((v) => v.toFixed(5))
            .join(" ")}`,
      ),
      ...rest,
    ].join("\n"),
  );
  const all = landmarksOf(halfFaceLandmarks);
  const landmarks = Object.fromEntries(Object.entries(all.landmarks).map(([name, point]) => [name, move(point)]));
  writeFileSync(landmarksFile, JSON.stringify({ ...all, landmarks }));
}
