// Lengths and angles that somebody measures on the face: they go along with the skin, and say what
// they were before.
import { computed, effect, signal } from "@preact/signals";
import { tool, type Ruler } from "../plan/tools";
import { readableMs } from "../run/state";
import { alongSkin, angleAt, placeNear, pointAt, type Place } from "../scene/measure";
import { distanceOf, type Hit, type Point } from "../scene/surface_geometry";
import type { Ball, Line } from "../scene/markers";
import { shownDistances, shownFrame, shownMesh } from "./shown";
import { shownScene } from "./stage_state";

export interface Measure {
  ruler: Ruler;
  /** on the face at rest [mm] */
  places: Point[];
}

/** A measure as it is on the face that is shown. */
export interface Reading {
  ruler: Ruler;
  points: Point[];
  /** the straight lines, or the way along the skin */
  path: Point[];
  /** [mm] or [degrees]; undefined where the skin ends between the places */
  value: number | undefined;
  /** the same on the face at rest */
  before: number | undefined;
}

export const placesOf: Record<Ruler, number> = { distance: 2, skin: 2, angle: 3 };
export const unitOf = (ruler: Ruler): string => (ruler === "angle" ? "°" : " mm");

export const measures = signal<Measure[]>([]);
/** places of the one that is being made */
const begun = signal<Point[]>([]);
/** counts the shapes that measures are read on */
const shape = signal(0);

function value(
  ruler: Ruler,
  points: ArrayLike<number>,
  triangles: Uint32Array,
  places: Place[],
): Omit<Reading, "before"> {
  const at = places.map((place) => pointAt(points, triangles, place));
  if (ruler === "angle") return { ruler, points: at, path: at, value: angleAt(at[0], at[1], at[2]) };
  if (ruler === "distance") return { ruler, points: at, path: at, value: distanceOf(at[0], at[1]) };
  const way = alongSkin(points, triangles, places[0], places[1]);
  return { ruler, points: at, path: way?.path ?? [], value: way?.lengthMm };
}

export const readings = computed<Reading[]>(() => {
  void [shape.value, shownMesh.value];
  const surface = measures.value.length > 0 ? shownScene.value?.shape : undefined;
  if (surface === undefined) return [];
  const { rest, points, triangles } = surface;
  return measures.value.map(({ ruler, places }) => {
    const found = places.map((at) => placeNear(rest, triangles, at));
    return { ...value(ruler, points, triangles, found), before: value(ruler, rest, triangles, found).value };
  });
});

const colour: [number, number, number] = [120, 40, 110];

/** What is drawn on the face of all measures, and of the one that is being made. */
export const rulerMarks = computed<{ balls: Ball[]; lines: Line[] }>(() => ({
  balls: [...readings.value.flatMap(({ points }) => points), ...begun.value].map((at) => ({ at, colour, radius: 1.1 })),
  lines: readings.value.map(({ path }) => ({ points: path, colour })),
}));

/** A click of a ruler on the face. */
export function addPlace(hit: Hit): void {
  const [now, surface] = [tool.value, shownScene.value?.shape];
  if (now.kind !== "measure" || surface === undefined) return;
  begun.value = [...begun.value, pointAt(surface.rest, surface.triangles, hit)];
  if (begun.value.length < placesOf[now.ruler]) return;
  measures.value = [...measures.value, { ruler: now.ruler, places: begun.value }];
  begun.value = [];
}

export function removeMeasure(index: number): void {
  measures.value = measures.value.filter((_, k) => k !== index);
}

/** Measures go along with the skin, and go with the face. */
export function bindRulers(): () => void {
  let due: ReturnType<typeof setTimeout> | undefined;
  let scanned: unknown;
  const ends = [
    effect(() => {
      void [shownFrame.value, shownMesh.value, shownDistances.value];
      // The picture moves the skin in its next refresh.
      due ??= setTimeout(() => {
        due = undefined;
        shape.value += 1;
      }, readableMs);
    }),
    effect(() => {
      if (tool.value.kind !== "measure" && begun.peek().length > 0) begun.value = [];
    }),
    effect(() => {
      const of = shownMesh.value?.points.length;
      if (of !== scanned && scanned !== undefined && of === undefined) measures.value = [];
      scanned = of;
    }),
  ];
  return () => {
    clearTimeout(due);
    ends.forEach((end) => end());
  };
}
