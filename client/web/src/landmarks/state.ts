// Guessed landmarks: they are beside the plan until somebody confirms them.
import { batch, computed, effect, signal } from "@preact/signals";
import { attempt } from "../activity";
import { landmarkNames } from "../plan/anatomy";
import { vectorOf } from "../plan/landmarks";
import { editPlan, region, scan, scanMesh } from "../plan/state";
import { trianglesOf } from "../api/meshes";
import type { Point } from "../scene/surface_geometry";
import { guessLandmarks, type Guess } from "./guess";
import { swap, swappedPairs } from "./swapped";

export const guesses = signal<Record<string, Guess>>({});
/** a landmark or a guess under the hand, where it is */
export const moved = signal<{ name: string; at: Point } | undefined>(undefined);

const points = computed(() => region.value?.landmarksMm ?? {});

/** Guesses of what nobody has set. */
export const openGuesses = computed(() =>
  Object.fromEntries(Object.entries(guesses.value).filter(([name]) => points.value[name] === undefined)),
);

/** They are in the order in which they are asked for. */
export const missing = computed(() => landmarkNames.filter((name) => points.value[name] === undefined));

export const swapped = computed(() => swappedPairs(points.value));

function put(into: Record<string, Point>): void {
  editPlan(({ model }) => {
    if (model?.geometry.case !== "scanRegion") return;
    for (const [name, at] of Object.entries(into)) model.geometry.value.landmarksMm[name] = vectorOf(at);
  });
}

export function guess(): Promise<boolean> {
  return attempt("Looking for landmarks", async () => {
    const mesh = scanMesh.value!;
    // The page says what it does before it is busy with it.
    await new Promise((resolve) => setTimeout(resolve, 50));
    const found = guessLandmarks(mesh.points, trianglesOf(mesh));
    if (found === undefined)
      throw new Error("no nose and chin between two like sides were found on this scan: click the landmarks by hand");
    if (scanMesh.value === mesh) guesses.value = found.points;
  });
}

export function confirm(name: string): void {
  const found = openGuesses.value[name];
  if (found) put({ [name]: found.at });
}

export function confirmAll(): void {
  put(Object.fromEntries(Object.entries(openGuesses.value).map(([name, { at }]) => [name, at])));
}

/** Puts a landmark where it was dragged to; a guess is confirmed by that. */
export function drop(): void {
  const now = moved.value;
  if (now === undefined) return;
  batch(() => {
    moved.value = undefined;
    put({ [now.name]: now.at });
  });
}

export function exchangeSides(): void {
  const pairs = swapped.value;
  editPlan(({ model }) => {
    if (model?.geometry.case === "scanRegion") swap(model.geometry.value.landmarksMm, pairs);
  });
}

/** Guesses are of one face. */
export function bindGuesses(): () => void {
  let of: string | undefined;
  return effect(() => {
    const now = scan.value?.name;
    if (now !== of) [guesses.value, moved.value] = [{}, undefined];
    of = now;
  });
}
