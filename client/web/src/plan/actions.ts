// What buttons of the planner do with plan files, landmarks and models.
import { batch } from "@preact/signals";
import { clone } from "@bufbuild/protobuf";
import { ModelSpecSchema } from "@wire/model_pb";
import { PlanSchema, type Plan } from "@wire/plan_pb";
import { attempt, remark } from "../activity";
import { buildModel } from "../api/model_build";
import { collectMeshes } from "../api/meshes";
import { patients } from "../api/client";
import { toProblem } from "../api/errors";
import { ensurePatient } from "./patient";
import { takeRegionFromZones } from "./anatomy";
import { parseLandmarks } from "./landmarks";
import { checkOnFace, hasPlaces, liesOn, removePlaces } from "./places";
import {
  editPlan,
  modelIsCurrent,
  model,
  plan,
  region,
  replacePlan,
  scan,
  scanFile,
  scanMesh,
  setModel,
  violations,
} from "./state";
import { toPlanFields } from "./violations";

/** @throws Error for what are no landmarks, or not those of this face */
export function takeLandmarks(text: string, unit = scanFile.value.unit, fileName?: string): void {
  const { points, axes, remarks = [] } = parseLandmarks(text, unit, fileName);
  checkOnFace(points, scanMesh.value);
  if (remarks.length > 0) remark.value = remarks.join(" ");
  editPlan(({ model: spec }) => {
    if (spec?.geometry.case !== "scanRegion") return;
    spec.geometry.value.landmarksMm = points;
    spec.geometry.value.axes = axes;
  });
}

/** What of a plan is of another face than the one on the page goes; the page says so. */
export function leaveOtherFace(next: Plan): void {
  if (!scanMesh.value || !hasPlaces(next) || liesOn(next, scanFile.value.name, scanMesh.value)) return;
  const of = next.scan?.file.split("/").pop() ?? "another scan";
  removePlaces(next);
  remark.value = `This plan was made on ${of}, not on this face. Its landmarks, and all that was drawn or painted on that face, were left out.`;
}

/**
 * A plan from a file; the scan and the landmarks of the page stay.
 * @throws Error for a plan of several parts of a face, of which the page shows one
 */
export function takePlan(next: Plan): void {
  if (next.parts.length > 0) {
    const names = next.parts.map(({ name }) => name).join(", ");
    throw new Error(
      `This plan has several parts of a face (${names}), and the page plans one part at a time. It was not opened; "lipofill run" carries out all of it.`,
    );
  }
  batch(() => {
    remark.value = "";
    leaveOtherFace(next);
    if (next.model?.geometry.case === "scanRegion") {
      const into = next.model.geometry.value;
      const before = region.value;
      into.scan = scan.value?.name ?? "";
      if (Object.keys(into.landmarksMm).length === 0 && before)
        Object.assign(into, { landmarksMm: before.landmarksMm, axes: before.axes });
    }
    takeRegionFromZones(next);
    replacePlan(next);
    violations.value = [];
    setModel(undefined, undefined);
  });
}

/** Builds the model that the plan describes, unless it is there. */
export async function build(): Promise<boolean> {
  if (modelIsCurrent.value) return true;
  violations.value = [];
  return attempt(
    "Building the model",
    async (progress, left) => {
      const parent = await ensurePatient();
      const spec = clone(ModelSpecSchema, plan.value.model!);
      try {
        const built = await buildModel(
          parent,
          spec,
          ({ fraction, stage }) => progress(fraction, `Building the model: ${stage}`),
          left,
        );
        const meshes = await collectMeshes(patients.downloadModelMesh({ name: built.name }));
        setModel(built, meshes);
      } catch (error) {
        violations.value = toPlanFields(toProblem(error).violations, "model");
        throw error;
      }
    },
    true,
  );
}

/** The plan as it goes to the daemon: on the model that was built. */
export function simulationSpec() {
  const spec = clone(PlanSchema, plan.value).simulation!;
  spec.model = model.value?.name ?? "";
  return spec;
}
