// The shape that is shown before a plan is run, or before fat is added to a run.
import { batch, computed, signal } from "@preact/signals";
import type { FoundShape } from "@wire/simulation_service_pb";
import type { Shape } from "../api/find_shape";
import type { Frame } from "../api/watch";
import { readableMs, runIsOpen } from "../run/state";
import { step } from "../stage/stage_state";

/** The plan of this page, or the run that it shows with more or less fat. */
export type ShapeOf = "plan" | "run";

/** Whose shape is looked for, from the first move of a slider on. */
export const shapeOf = signal<ShapeOf | undefined>(undefined);
export const shapeFrame = signal<Frame | undefined>(undefined);
/** of the shape, for people: no faster than they can be read */
export const figures = signal<FoundShape | undefined>(undefined);
/** It was found from the beginning, for volumes that no longer change. */
export const isFinal = signal(false);
/** why there is no shape of what is wanted */
export const refusal = signal("");
/** Volumes under the hand, by the injection's place in the plan [mL]. */
export const dragged = signal<ReadonlyMap<number, number>>(new Map());

/** Whose shape is shown: that of the plan gives way to a run where runs are shown. */
export const shownShapeOf = computed<ShapeOf | undefined>(() => {
  if (shapeOf.value === "run") return step.value === "run" ? "run" : undefined;
  const wanted = step.value === "fat" || (step.value === "run" && !runIsOpen.value);
  return wanted ? shapeOf.value : undefined;
});

let figuresDue: ReturnType<typeof setTimeout> | undefined;
let newest: FoundShape | undefined;

export function show({ found, frame }: Shape, final: boolean): void {
  newest = found;
  if (final) clearTimeout(figuresDue);
  else
    figuresDue ??= setTimeout(() => {
      figuresDue = undefined;
      figures.value = newest;
    }, readableMs);
  batch(() => {
    [shapeFrame.value, isFinal.value, refusal.value] = [frame, final, ""];
    if (!final) return;
    figuresDue = undefined;
    figures.value = found;
  });
}

/** There is no shape of what is wanted: only the face, or the run, is shown, and why. */
export function refuse(why: string): void {
  clearTimeout(figuresDue);
  [figuresDue, newest] = [undefined, undefined];
  batch(() => {
    [shapeFrame.value, figures.value, isFinal.value, refusal.value] = [undefined, undefined, false, why];
  });
}

export function clear(): void {
  batch(() => {
    refuse("");
    [shapeOf.value, dragged.value] = [undefined, new Map()];
  });
}
