// What the face is to look like, what it lacks to that, and what was proposed to fill it.
import { batch, computed, signal } from "@preact/signals";
import { ScanUnit } from "@wire/plan_pb";
import type { Scan } from "@wire/patient_service_pb";
import { FaceSide, type Deficit, type Delivery, type Proposal } from "@wire/planning_service_pb";
import type { Mesh } from "../api/meshes";
import { plan, region } from "../plan/state";
import { toJsonString } from "@bufbuild/protobuf";
import { SimulationSpecSchema } from "@wire/simulation_pb";
import type { ColourMap } from "../scene/colour_maps";
import { deficitMap } from "../scene/deficit_map";

/** The target that is open: a scan of the patient with a report of how it was made. */
export const target = signal<Scan | undefined>(undefined);
export const targetMesh = signal<Mesh | undefined>(undefined);
export const deficit = signal<Deficit | undefined>(undefined);
/** the landmarks that the deficit was measured with */
export const measuredWith = signal("");
export const earlierTargets = signal<Scan[]>([]);

/** What the picture shows while the goal is looked at. */
export type GoalView = "missing" | "target" | "face";
export const goalView = signal<GoalView>("missing");

/** How a target is asked for. */
export const wanted = signal({
  healthySide: FaceSide.RIGHT as FaceSide.LEFT | FaceSide.RIGHT,
  unit: ScanUnit.MILLIMETRE,
  inPlace: false,
});

export const proposal = signal<Proposal | undefined>(undefined);
/** the point of the curve that is in the plan, and the plan as it then was */
export const picked = signal<{ point: number; planText: string } | undefined>(undefined);
export const delivery = signal<{ list: Delivery; planText: string } | undefined>(undefined);

export const landmarksText = computed(() => JSON.stringify(region.value?.landmarksMm ?? {}));
export const planText = computed(() =>
  plan.value.simulation ? toJsonString(SimulationSpecSchema, plan.value.simulation) : "",
);
/** Landmarks have moved since: regions lie elsewhere now. */
export const deficitIsOld = computed(() => deficit.value !== undefined && measuredWith.value !== landmarksText.value);
export const pickedPoint = computed(() => (picked.value?.planText === planText.value ? picked.value.point : undefined));
export const deliveryIsOld = computed(() => delivery.value !== undefined && delivery.value.planText !== planText.value);

export const distances = computed(() => {
  const values = deficit.value?.distanceMm ?? [];
  return values.length === 0 ? undefined : Float32Array.from(values);
});
export const distanceMap = computed<ColourMap | undefined>(() => distances.value && deficitMap(distances.value));

export function forgetTarget(): void {
  batch(() => {
    [target.value, targetMesh.value, deficit.value, measuredWith.value] = [undefined, undefined, undefined, ""];
    [proposal.value, picked.value] = [undefined, undefined];
    goalView.value = "missing";
  });
}

/** Nothing of it is of the next patient. */
export function forgetGoal(): void {
  batch(() => {
    forgetTarget();
    [earlierTargets.value, delivery.value] = [[], undefined];
  });
}
