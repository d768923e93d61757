// What of a plan lies on one face, and on no other.
import type { SkinPoint, Vector3 } from "@wire/geometry_pb";
import type { Plan } from "@wire/plan_pb";
import type { Zone } from "@wire/simulation_pb";
import type { Mesh } from "../api/meshes";
import type { Point } from "../scene/surface_geometry";
import { aroundOf, takeRegionFromZones } from "./anatomy";
import { pointOf } from "./landmarks";

/**
 * Points of another face, or in another unit, lie farther off the skin than this, by their median
 * [mm]. Points by hand lie within 3 mm, also on coarse scans.
 */
export const mostOffMm = 5;

function distanceToMesh([x, y, z]: Point, points: ArrayLike<number>): number {
  let least = Infinity;
  for (let k = 0; k < points.length; k += 3) {
    const d = (points[k] - x) ** 2 + (points[k + 1] - y) ** 2 + (points[k + 2] - z) ** 2;
    if (d < least) least = d;
  }
  return Math.sqrt(least);
}

/** The median of how far points are from the nearest vertex [mm]; undefined without points. */
export function medianOff(points: Point[], mesh: Mesh): number | undefined {
  const distances = points.map((point) => distanceToMesh(point, mesh.points)).sort((a, b) => a - b);
  return distances[Math.floor(distances.length / 2)];
}

export const pointsOf = (landmarks: Record<string, Vector3>): Point[] => Object.values(landmarks).map(pointOf);

/** @throws Error that says how far the landmarks are off the face */
export function checkOnFace(landmarks: Record<string, Vector3>, mesh: Mesh | undefined): void {
  const off = mesh && medianOff(pointsOf(landmarks), mesh);
  if (off === undefined || off <= mostOffMm) return;
  throw new Error(
    `These landmarks are of another face, or in another unit: half of them lie more than ${off.toFixed(0)} mm off this one. They were not taken.`,
  );
}

const isPlaced = (point: SkinPoint | undefined): boolean => point?.place.case === "positionMm";

function skinPoints({ model, simulation }: Plan): (SkinPoint | undefined)[] {
  const region = model?.geometry.case === "scanRegion" ? model.geometry.value : undefined;
  const films = simulation?.films ?? [];
  return [
    ...(region?.corners ?? []),
    ...(region?.around?.discs ?? []).map(({ centre }) => centre),
    ...films.flatMap(({ zones }) => zones.map(({ shape }) => (shape.case === "disc" ? shape.value.centre : undefined))),
    ...films.flatMap(({ walls }) => walls.flatMap(({ place }) => (place.case === "path" ? place.value.points : []))),
    ...(simulation?.ligaments ?? []).flatMap(({ place }) => (place.case === "points" ? place.value.points : [])),
    ...(simulation?.injections ?? []).map(({ site }) => site),
    ...(simulation?.probes ?? []).map(({ place }) => place),
  ];
}

/** All that a plan gives in the frame of its scan. */
export function positionsOf(plan: Plan): Point[] {
  const { model } = plan;
  const landmarks = model?.geometry.case === "scanRegion" ? pointsOf(model.geometry.value.landmarksMm) : [];
  const placed = skinPoints(plan).flatMap((point) =>
    point?.place.case === "positionMm" ? [pointOf(point.place.value)] : [],
  );
  return [...landmarks, ...placed];
}

function isOfOneFace({ shape }: Zone): boolean {
  return shape.case === "painted" || (shape.case === "disc" && isPlaced(shape.value.centre));
}

const hasPainted = ({ simulation }: Plan): boolean =>
  (simulation?.films ?? []).some(({ zones }) => zones.some(isOfOneFace));

/** Depths that were measured in one head, as by its bone. */
const hasDepths = ({ model }: Plan): boolean =>
  (model?.geometry.case === "scanRegion" && model.geometry.value.boneScan !== "") ||
  (model?.layers ?? []).some(({ downToBone, thicknessMm }) => downToBone ?? thicknessMm?.kind.case === "samples");

/** Whether a plan has anything that is of one face only. */
export const hasPlaces = (plan: Plan): boolean => positionsOf(plan).length > 0 || hasPainted(plan) || hasDepths(plan);

function forgetRegion({ model }: Plan): void {
  if (model?.geometry.case !== "scanRegion") return;
  const region = model.geometry.value;
  Object.assign(region, { scan: "", landmarksMm: {}, axes: undefined, boneScan: "" });
  if (region.corners.some(isPlaced)) region.corners = [];
  if (region.around) region.around.discs = region.around.discs.filter(({ centre }) => !isPlaced(centre));
  for (const layer of model.layers) {
    layer.downToBone = undefined;
    if (layer.thicknessMm?.kind.case === "samples") layer.thicknessMm = undefined;
  }
}

/** Takes everything out of a plan that lies on one face only; the rest serves any face. */
export function removePlaces(plan: Plan): void {
  const { model, simulation } = plan;
  [plan.scan, plan.bone] = [undefined, undefined];
  forgetRegion(plan);
  if (simulation) {
    const gone = new Set(simulation.films.flatMap(({ zones }) => zones.filter(isOfOneFace).map(({ name }) => name)));
    for (const film of simulation.films) {
      film.zones = film.zones.filter((zone) => !isOfOneFace(zone));
      film.walls = film.walls.filter(({ place }) => place.case !== "path" || !place.value.points.some(isPlaced));
    }
    simulation.injections = simulation.injections.filter(({ zone }) => !gone.has(zone));
    for (const injection of simulation.injections) if (isPlaced(injection.site)) injection.site = undefined;
    simulation.ligaments = simulation.ligaments.filter(
      ({ place }) => place.case !== "points" || !place.value.points.some(isPlaced),
    );
    simulation.probes = simulation.probes.filter(({ place }) => !isPlaced(place));
    simulation.model = "";
  }
  takeRegionFromZones(plan);
  if (model?.geometry.case !== "scanRegion") return;
  const { corners, around } = model.geometry.value;
  if (corners.length === 0 && (around === undefined || (around.regions.length === 0 && around.discs.length === 0)))
    model.geometry.value.around = aroundOf("jaw_zones", "left");
}

const baseName = (path: string): string => path.split(/[/\\]/).pop()!;

/**
 * Whether what a plan gives in the frame of a scan lies on this one. A plan that names another file
 * is of another face, however near its points are.
 * @param file  the name of the scan's file; empty: not known
 */
export function liesOn(plan: Plan, file: string, mesh: Mesh): boolean {
  const named = plan.scan?.file ?? "";
  if (file !== "" && named !== "" && baseName(named) !== baseName(file)) return false;
  const off = medianOff(positionsOf(plan), mesh);
  return off === undefined || off <= mostOffMm;
}
