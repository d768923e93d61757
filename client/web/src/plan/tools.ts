// What a click on the face does.
import { signal } from "@preact/signals";
import { create } from "@bufbuild/protobuf";
import { SkinPointSchema, type SkinPoint } from "@wire/geometry_pb";
import { SkinPathSchema, SkinPointsSchema } from "@wire/simulation_pb";
import type { Point } from "../scene/surface_geometry";
import { vectorOf } from "./landmarks";
import { landmarkHints, landmarkNames } from "./anatomy";
import { chart, editPlan, plan, region } from "./state";

/** What is measured: straight, along the skin, or between two lines. */
export type Ruler = "distance" | "skin" | "angle";

export type Tool =
  | { kind: "turn" }
  | { kind: "landmark"; name: string; guided?: boolean }
  | { kind: "corner"; index: number }
  | { kind: "site"; index: number }
  | { kind: "live_site" }
  | { kind: "measure"; ruler: Ruler }
  | { kind: "wall"; film: number; index: number }
  | { kind: "ligament"; index: number }
  | { kind: "paint"; film: number; zone: number; erase: boolean };

export const tool = signal<Tool>({ kind: "turn" });
export const brushMm = signal(6);
/** where the next live injection goes; undefined: evenly over its zone */
export const liveSite = signal<SkinPoint | undefined>(undefined);

export function toolHint(now: Tool): string {
  switch (now.kind) {
    case "landmark":
      return `Click on the face: ${now.name.replace(/_/g, " ")}${hintOf(now.name)}`;
    case "corner":
      return `Click where corner ${now.index + 1} of the region goes`;
    case "site":
    case "live_site":
      return "Click where the cannula delivers";
    case "measure":
      return now.ruler === "angle"
        ? "Click three places: the angle is at the second; Esc when done"
        : "Click two places on the face; Esc when done";
    case "wall":
      return "Click points of the wall one after the other; Esc when done";
    case "ligament":
      return "Click where the ligament's fibres are; Esc when done";
    case "paint":
      return `${now.erase ? "Erase" : "Paint"} by dragging over the region; drag beside it to turn; [ and ] change the brush`;
    default:
      return "";
  }
}

export const skinPointAt = (at: Point): SkinPoint =>
  create(SkinPointSchema, { place: { case: "positionMm", value: vectorOf(at) } });

const hintOf = (name: string): string => {
  const hint = landmarkHints[name.replace(/_(left|right)$/, "")];
  return hint === undefined ? "" : `, ${hint}`;
};

/** The next landmark that is not set, after one; from the first on where there is none. */
export function goOn(after?: string): void {
  const known = region.value?.landmarksMm ?? {};
  const from = after === undefined ? 0 : landmarkNames.indexOf(after) + 1;
  const name = landmarkNames.slice(from).find((one) => known[one] === undefined);
  tool.value = name === undefined ? { kind: "turn" } : { kind: "landmark", name, guided: true };
}

/** Carries out a click at a place on the skin. */
export function click(at: Point): void {
  const now = tool.value;
  const place = skinPointAt(at);
  switch (now.kind) {
    case "landmark":
      editPlan(({ model }) => {
        if (model?.geometry.case === "scanRegion") model.geometry.value.landmarksMm[now.name] = vectorOf(at);
      });
      if (now.guided) return goOn(now.name);
      break;
    case "corner":
      editPlan(({ model }) => {
        if (model?.geometry.case === "scanRegion") model.geometry.value.corners[now.index] = place;
      });
      break;
    case "site":
      editPlan(({ simulation }) => (simulation!.injections[now.index].site = place));
      break;
    case "live_site":
      liveSite.value = place;
      break;
    case "wall":
      editPlan(({ simulation }) => {
        const wall = simulation!.films[now.film].walls[now.index];
        const points = wall.place.case === "path" ? wall.place.value.points : [];
        wall.place = { case: "path", value: create(SkinPathSchema, { points: [...points, place] }) };
      });
      return;
    case "ligament":
      editPlan(({ simulation }) => {
        const ligament = simulation!.ligaments[now.index];
        const points = ligament.place.case === "points" ? ligament.place.value.points : [];
        ligament.place = { case: "points", value: create(SkinPointsSchema, { points: [...points, place] }) };
      });
      return;
    default:
      return;
  }
  tool.value = { kind: "turn" };
}

/** A dab of the brush; whether the zone changed. Dabs of one stroke are taken back together. */
export function dab(at: Point, stroke: unknown): boolean {
  const now = tool.value;
  const over = chart.value;
  if (now.kind !== "paint" || over === undefined) return false;
  const shape = plan.value.simulation?.films[now.film]?.zones[now.zone]?.shape;
  const samples =
    shape?.case === "painted" && over.fits(shape.value)
      ? { ...shape.value, values: [...shape.value.values] }
      : over.empty();
  if (!over.brush(samples, at, brushMm.value, now.erase ? 0 : 1)) return false;
  editPlan(
    ({ simulation }) => (simulation!.films[now.film].zones[now.zone].shape = { case: "painted", value: samples }),
    stroke,
  );
  return true;
}
