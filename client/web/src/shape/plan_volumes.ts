// Volumes of the plan's injections under sliders: the skin follows them, letting go changes the
// plan.
import { batch, computed, effect, untracked } from "@preact/signals";
import { clone, toJsonString } from "@bufbuild/protobuf";
import { Simulation_State, SimulationSpecSchema, type SimulationSpec } from "@wire/simulation_pb";
import { newId } from "../api/client";
import type { ShapeRequest } from "../api/find_shape";
import { simulationSpec } from "../plan/actions";
import { editPlan, modelIsCurrent, plan } from "../plan/state";
import { recorded, simulation, state } from "../run/state";
import { beginDrag, findFinal, findWhileDragged, forgetShape } from "./finder";
import { dragged, shapeOf } from "./state";

const planText = (): string => (plan.value.simulation ? toJsonString(SimulationSpecSchema, plan.value.simulation) : "");

/** The plan that the shape is of. */
let textOfShape = "";

/**
 * The plan as the daemon is asked about it: as long as only volumes change it stays as it was at
 * first, and what the daemon made for it serves every shape.
 */
let asked: { spec: SimulationSpec; text: string; drag: string } | undefined;

function askedPlan() {
  const spec = simulationSpec();
  const still = clone(SimulationSpecSchema, spec);
  for (const injection of still.injections) injection.volumeMl = undefined;
  const text = toJsonString(SimulationSpecSchema, still);
  if (asked?.text !== text) asked = { spec, text, drag: newId() };
  return asked;
}

/** The plan with the volumes under the hand in place of its own. */
function request(): ShapeRequest {
  const { spec, drag } = asked ?? askedPlan();
  const injections = plan.value.simulation!.injections.map(({ volumeMl }, index) => ({
    index,
    volumeMl: dragged.value.get(index) ?? volumeMl ?? 0,
  }));
  return { plan: { case: "spec", value: spec }, injections, drag };
}

const face = (): string => (plan.value.model?.geometry.case === "scanRegion" ? "scan" : "skin");

/** The end of the slider: it goes further only when a volume is near it. */
export function mostOf(volumeMl: number): number {
  let most = 5;
  while (most < 1.05 * Math.abs(volumeMl)) most *= 2;
  return most;
}

export function dragVolume(index: number, volumeMl: number): void {
  dragged.value = new Map(dragged.value).set(index, volumeMl);
  if (!modelIsCurrent.value) return;
  if (beginDrag("plan")) {
    dragged.value = new Map([[index, volumeMl]]);
    textOfShape = planText();
    askedPlan();
  }
  findWhileDragged(face(), request());
}

/** The plan has the volume from now on. */
export function releaseVolume(index: number, volumeMl: number): void {
  const others = new Map(dragged.value);
  others.delete(index);
  batch(() => {
    editPlan(({ simulation: into }) => (into!.injections[index].volumeMl = volumeMl));
    dragged.value = others;
    textOfShape = planText();
    if (others.size === 0 && shapeOf.value === "plan") findFinal(face(), request());
  });
}

/** Shows the settled shape of the plan as it is. */
export function showPlanShape(): void {
  if (!modelIsCurrent.value) return;
  forgetShape();
  beginDrag("plan");
  textOfShape = planText();
  askedPlan();
  findFinal(face(), request());
}

/** Forgets a shape that is no longer that of the plan or the run, or that a run replaces. */
export function bindShape(): () => void {
  const run = computed(() => `${simulation.value?.name ?? ""} ${recorded.value}`);
  const ends = [
    effect(() => {
      void [plan.value, modelIsCurrent.value];
      if (shapeOf.peek() !== "plan") return;
      if (!modelIsCurrent.value || planText() !== textOfShape) untracked(forgetShape);
    }),
    effect(() => {
      void run.value;
      untracked(forgetShape);
    }),
    effect(() => {
      if (state.value !== Simulation_State.SETTLED && shapeOf.peek() === "run") untracked(forgetShape);
    }),
  ];
  return () => ends.forEach((end) => end());
}
