// Landmarks: files of them, and points that are given by them.
import { create } from "@bufbuild/protobuf";
import {
  HeadAxesSchema,
  Vector3Schema,
  type HeadAxes,
  type LandmarkPoint,
  type SkinPoint,
  type Vector3,
} from "@wire/geometry_pb";
import type { Point } from "../scene/surface_geometry";
import { ScanUnit } from "@wire/plan_pb";
import {
  parseFcsv,
  parseMarkups,
  parsePickedPoints,
  parseTable,
  type LandmarkList,
  type Markup,
} from "./landmark_files";
import { understandName } from "./landmark_names";

export interface Landmarks {
  points: Record<string, Vector3>;
  axes?: HeadAxes;
  /** what was made of the file, a sentence each */
  remarks?: string[];
}

export function vectorOf(point: ArrayLike<number>): Vector3 {
  return create(Vector3Schema, { x: point[0], y: point[1], z: point[2] });
}
export function pointOf(vector: Vector3): Point {
  return [vector.x ?? 0, vector.y ?? 0, vector.z ?? 0];
}

export function millimetresPer(unit: ScanUnit): number {
  return unit === ScanUnit.METRE ? 1000 : unit === ScanUnit.CENTIMETRE ? 10 : 1;
}

function readPoint(value: unknown, what: string): Point {
  if (Array.isArray(value) && value.length === 3 && value.every((v) => typeof v === "number" && Number.isFinite(v)))
    return value as Point;
  throw new Error(`${what} is ${JSON.stringify(value)}, must be three numbers`);
}

interface OwnDocument {
  landmarks?: unknown;
  axes?: Record<string, unknown>;
  units?: unknown;
  markups?: unknown;
}

function unitOf(document: OwnDocument, unit: ScanUnit): number {
  if (document.units === undefined) return millimetresPer(unit);
  const factor = { mm: 1, cm: 10, m: 1000 }[document.units as string];
  if (factor === undefined) throw new Error(`units is ${JSON.stringify(document.units)}, must be "mm", "cm" or "m"`);
  return factor;
}

/** The project's own JSON. In it the names of the file stay beside those they are understood as. */
function readOwn(document: OwnDocument, unit: ScanUnit): Landmarks {
  if (typeof document.landmarks !== "object" || document.landmarks === null)
    throw new Error('this file has no object "landmarks"');
  const factor = unitOf(document, unit);
  const points: Record<string, Vector3> = {};
  for (const [name, value] of Object.entries(document.landmarks))
    points[name] = vectorOf(readPoint(value, `landmarks.${name}`).map((v) => v * factor));
  for (const name of Object.keys(points)) {
    const understood = understandName(name);
    if (understood !== undefined) points[understood] ??= points[name];
  }
  const { axes } = document;
  if (axes === undefined) return { points };
  const [left, up, forward] = ["left", "up", "forward"].map((name) => vectorOf(readPoint(axes[name], `axes.${name}`)));
  return { points, axes: create(HeadAxesSchema, { left, up, forward }) };
}

/** Landmarks by the daemon's names, from a list in whatever names. */
function takeList(list: LandmarkList, unit: ScanUnit): Landmarks {
  const factor = list.millimetresPerUnit ?? millimetresPer(unit);
  const points: Record<string, Vector3> = {};
  for (const [given, at] of list.points) {
    const name = understandName(given) ?? given;
    if (points[name] !== undefined) throw new Error(`the landmark ${name} is there twice, once as ${given}`);
    points[name] = vectorOf(at.map((v) => v * factor));
  }
  if (list.points.length === 0) throw new Error("this file has no landmark");
  const unknown = list.points.filter(([given]) => understandName(given) === undefined).length;
  const remarks = [
    ...(list.wasRas ? ["The landmarks are in RAS and were turned to LPS."] : []),
    ...(unknown > 0 ? [`${unknown} of the names are not known as landmarks and stay as they are.`] : []),
  ];
  return { points, remarks };
}

/**
 * A landmarks file as `lipofill run` takes it: the project's own JSON (an object "landmarks" of
 * name to [x, y, z], optionally "axes" and "units"), or, by the ending of its name, a file of 3D
 * Slicer (.mrk.json, .fcsv), MeshLab (.pp) or a table (.csv, .tsv, .txt).
 */
export function parseLandmarks(text: string, unit: ScanUnit, fileName = "landmarks.json"): Landmarks {
  const ending = fileName.slice(fileName.lastIndexOf(".")).toLowerCase();
  if (ending === ".fcsv") return takeList(parseFcsv(text), unit);
  if (ending === ".pp") return takeList(parsePickedPoints(text), unit);
  if ([".csv", ".tsv", ".txt"].includes(ending)) return takeList(parseTable(text), unit);
  const document = JSON.parse(text.replace(/^\uFEFF/, "")) as OwnDocument | null;
  if (typeof document !== "object" || document === null) throw new Error('this file has no object "landmarks"');
  if (Array.isArray(document.markups)) return takeList(parseMarkups(document.markups as Markup[]), unit);
  return readOwn(document, unit);
}

export function writeLandmarks(points: Record<string, Vector3>, axes: HeadAxes | undefined): string {
  const landmarks = Object.fromEntries(Object.entries(points).map(([name, vector]) => [name, pointOf(vector)]));
  const given =
    axes?.left && axes.up && axes.forward
      ? { axes: { left: pointOf(axes.left), up: pointOf(axes.up), forward: pointOf(axes.forward) } }
      : {};
  return `${JSON.stringify({ units: "mm", ...given, landmarks }, null, 1)}\n`;
}

const unit = (v: Point): Point => {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length) as Point;
};
const cross = (a: Point, b: Point): Point => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const minus = (a: Point, b: Point): Point => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

/**
 * The head's axes as given, else guessed from the landmarks: enough to show a face upright; the
 * daemon has its own.
 */
export function axesOf(
  points: Record<string, Vector3>,
  given: HeadAxes | undefined,
): { left: Point; up: Point; forward: Point } {
  if (given?.left && given.up && given.forward)
    return { left: pointOf(given.left), up: pointOf(given.up), forward: pointOf(given.forward) };
  const at = (name: string): Point | undefined => (points[name] ? pointOf(points[name]) : undefined);
  const [top, bottom] = [at("nasion"), at("menton") ?? at("pogonion") ?? at("subnasale")];
  const pair = ["cheilion", "exocanthion", "zygion", "gonion", "alare"].find(
    (name) => at(`${name}_left`) && at(`${name}_right`),
  );
  if (!top || !bottom || !pair) return { left: [1, 0, 0], up: [0, 1, 0], forward: [0, 0, 1] };
  const left = unit(minus(at(`${pair}_left`)!, at(`${pair}_right`)!));
  const forward = unit(cross(left, minus(top, bottom)));
  return { left, up: cross(forward, left), forward };
}

function fromLandmarks(
  place: LandmarkPoint,
  points: Record<string, Vector3>,
  axes: ReturnType<typeof axesOf>,
): Point | undefined {
  const sum = Object.values(place.weights).reduce((total, weight) => total + weight, 0);
  const at: Point = [0, 0, 0];
  for (const [name, weight] of Object.entries(place.weights)) {
    if (points[name] === undefined) return undefined;
    pointOf(points[name]).forEach((v, c) => (at[c] += (weight / sum) * v));
  }
  const offsets: [number | undefined, Point][] = [
    [place.leftMm, axes.left],
    [place.upMm, axes.up],
    [place.forwardMm, axes.forward],
  ];
  for (const [mm, axis] of offsets) axis.forEach((v, c) => (at[c] += (mm ?? 0) * v));
  return at;
}

/**
 * Where a point of the skin is, near the skin; undefined while that is not known on this side of
 * the wire.
 */
export function locate(
  place: SkinPoint,
  points: Record<string, Vector3>,
  given: HeadAxes | undefined,
  chart?: (xi: number, eta: number) => Point,
): Point | undefined {
  switch (place.place.case) {
    case "positionMm":
      return pointOf(place.place.value);
    case "landmarks":
      return fromLandmarks(place.place.value, points, axesOf(points, given));
    case "chart":
      return chart?.(place.place.value.xi ?? 0, place.place.value.eta ?? 0);
    default:
      return undefined;
  }
}
