// The plan under work, and what it stands on: the scan, the model built from it.
import { clone, toJsonString } from "@bufbuild/protobuf";
import { batch, computed, signal } from "@preact/signals";
import type { Scan } from "@wire/patient_service_pb";
import { ModelSpecSchema, type Model } from "@wire/model_pb";
import { PlanSchema, ScanUnit, type Plan } from "@wire/plan_pb";
import type { Violation } from "../api/errors";
import type { Mesh } from "../api/meshes";
import { Chart } from "./chart";
import { History } from "./history";
import { newPlan } from "./new_plan";

export const plan = signal<Plan>(newPlan());
/** patients/{patient}; empty: none yet */
export const patient = signal("");
/** its pseudonym */
export const patientName = signal("");
export const scan = signal<Scan | undefined>(undefined);
export const scanMesh = signal<Mesh | undefined>(undefined);
/** name and unit of the file the scan came from; without a name where that is not known */
export const scanFile = signal({ name: "", unit: ScanUnit.MILLIMETRE });
export const fileOfScan = computed(() => scanFile.value.name || "face.obj");
export const model = signal<Model | undefined>(undefined);
export const modelMeshes = signal<Map<string, Mesh> | undefined>(undefined);
/** of the specification that `model` was built from */
export const builtFrom = signal("");

/** what the daemon has against the plan */
export const violations = signal<Violation[]>([]);

export const chart = computed(() => {
  const skin = modelMeshes.value?.get("skin");
  return skin === undefined ? undefined : new Chart(skin);
});
export const region = computed(() => {
  const geometry = plan.value.model?.geometry;
  return geometry?.case === "scanRegion" ? geometry.value : undefined;
});
/** A plan needs a face, unless it is of a plate. */
export const canRun = computed(() => scan.value !== undefined || plan.value.model?.geometry.case === "square");
export const zones = computed(() =>
  (plan.value.simulation?.films ?? []).flatMap((film) => film.zones.map((zone) => ({ film, zone }))),
);

export const specText = computed(() => (plan.value.model ? toJsonString(ModelSpecSchema, plan.value.model) : ""));
/** Whether the model is the one that the plan describes. */
export const modelIsCurrent = computed(() => model.value !== undefined && builtFrom.value === specText.value);

const history = new History<Plan>();
export const canUndo = computed(() => history.canUndo);
export const canRedo = computed(() => history.canRedo);

/** @param stroke  edits with the same one are taken back together, as those of a stroke of the brush */
export function editPlan(change: (next: Plan) => void, stroke?: unknown): void {
  const next = clone(PlanSchema, plan.value);
  change(next);
  replacePlan(next, stroke);
}

export function replacePlan(next: Plan, stroke?: unknown): void {
  history.add(plan.value, stroke);
  plan.value = next;
}

/** A plan of another face: the changes of the one before are not its own. */
export function startPlan(next: Plan): void {
  history.forget();
  plan.value = next;
}

function goTo(next: Plan | undefined): void {
  if (next === undefined) return;
  batch(() => {
    plan.value = next;
    violations.value = [];
  });
}
export const undo = (): void => goTo(history.undo(plan.value));
export const redo = (): void => goTo(history.redo(plan.value));

/** @param from  the specification that the model was built from; absent: the plan's */
export function setModel(built: Model | undefined, meshes: Map<string, Mesh> | undefined, from?: string): void {
  batch(() => {
    modelMeshes.value = meshes;
    model.value = built;
    builtFrom.value = built === undefined ? "" : (from ?? specText.value);
  });
}
