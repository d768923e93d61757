// What buttons of the planner do with patients, scans, models and plan files.
import { batch } from "@preact/signals";
import { clone } from "@bufbuild/protobuf";
import { ModelSpecSchema } from "@wire/model_pb";
import type { Scan } from "@wire/patient_service_pb";
import { PlanSchema, ScanUnit, type Plan } from "@wire/plan_pb";
import { buildModel } from "../api/model_build";
import { collectMeshes } from "../api/meshes";
import { newId, patients } from "../api/client";
import { toProblem } from "../api/errors";
import { uploadScan } from "../api/upload";
import { takeRegionFromZones } from "./anatomy";
import { parseLandmarks } from "./landmarks";
import { parsePlan } from "./plan_file";
import {
  editPlan,
  modelIsCurrent,
  model,
  patient,
  plan,
  region,
  scan,
  scanFile,
  scanMesh,
  setModel,
  violations,
} from "./state";
import { attempt, notice } from "../activity";
import { toPlanFields } from "./violations";

/** The patient of this page; made up when there is none yet. */
async function ensurePatient(displayName: string): Promise<string> {
  if (patient.value === "") patient.value = (await patients.createPatient({ requestId: newId(), displayName })).name;
  return patient.value;
}

const asId = (text: string): string =>
  text
    .toLowerCase()
    .replace(/\.[^.]*$/, "")
    .replace(/[^a-z0-9]+/g, "-")
    .replace(/^-+|-+$/g, "")
    .slice(0, 63);

export async function pickScan(next: Scan): Promise<void> {
  await attempt("Loading the face", async () => {
    const meshes = await collectMeshes(patients.downloadScanMesh({ name: next.name }));
    showScan(next, meshes);
  });
}

function showScan(next: Scan, meshes: Awaited<ReturnType<typeof collectMeshes>>): void {
  batch(() => {
    setModel(undefined, undefined);
    scan.value = next;
    scanMesh.value = meshes.get("scan");
    violations.value = [];
    editPlan(({ model: spec }) => {
      if (spec?.geometry.case === "scanRegion") spec.geometry.value.scan = next.name;
    });
  });
}

export async function uploadFace(fileName: string, content: ArrayBuffer, unit: ScanUnit): Promise<boolean> {
  return attempt(`Sending ${fileName}`, async (progress) => {
    const parent = await ensurePatient(asId(fileName));
    const made = await uploadScan(parent, fileName, content, unit, (share) => progress(share));
    progress(1, "Loading the face");
    const meshes = await collectMeshes(patients.downloadScanMesh({ name: made.name }));
    scanFile.value = { name: fileName, unit };
    showScan(made, meshes);
  });
}

export function takeLandmarks(text: string, unit = scanFile.value.unit, fileName?: string): void {
  const { points, axes, remarks = [] } = parseLandmarks(text, unit, fileName);
  if (remarks.length > 0) notice.value = remarks.join(" ");
  editPlan(({ model: spec }) => {
    if (spec?.geometry.case !== "scanRegion") return;
    spec.geometry.value.landmarksMm = points;
    spec.geometry.value.axes = axes;
  });
}

/** A plan from a file; the scan and the landmarks of the page stay. */
export function takePlan(next: Plan): void {
  batch(() => {
    const before = region.value;
    if (next.model?.geometry.case === "scanRegion") {
      const into = next.model.geometry.value;
      into.scan = scan.value?.name ?? "";
      if (Object.keys(into.landmarksMm).length === 0 && before)
        Object.assign(into, { landmarksMm: before.landmarksMm, axes: before.axes });
    }
    takeRegionFromZones(next);
    plan.value = next;
    violations.value = [];
    setModel(undefined, undefined);
  });
}

async function sample(path: string): Promise<Response> {
  const response = await fetch(`samples/${path}`);
  if (!response.ok) throw new Error(`the sample ${path} is not there: this gateway has no --samples`);
  return response;
}

/** The synthetic face that comes with the project, and a plan on it. */
export async function openSample(name = "jaw_angle"): Promise<void> {
  const ready = await attempt("Opening the sample", async (progress) => {
    const next = parsePlan(await (await sample(`plans/${name}.json`)).text());
    const file = next.scan?.file.replace(/^\.\.\//, "") ?? "";
    if (file === "") return takePlan(next);
    const [face, landmarks] = await Promise.all([
      sample(file).then((r) => r.arrayBuffer()),
      sample(next.scan!.landmarksFile.replace(/^\.\.\//, "")).then((r) => r.text()),
    ]);
    const parent = await ensurePatient("synthetic-face");
    const made = await uploadScan(parent, file.split("/").pop()!, face, ScanUnit.MILLIMETRE, (share) =>
      progress(share, "Sending the face"),
    );
    const meshes = await collectMeshes(patients.downloadScanMesh({ name: made.name }));
    batch(() => {
      scanFile.value = { name: file.split("/").pop()!, unit: ScanUnit.MILLIMETRE };
      takePlan(next);
      takeLandmarks(landmarks, ScanUnit.MILLIMETRE);
      showScan(made, meshes);
    });
  });
  if (ready) await build();
}

/** Builds the model that the plan describes, unless it is there. */
export async function build(): Promise<boolean> {
  if (modelIsCurrent.value) return true;
  violations.value = [];
  return attempt("Building the model", async (progress) => {
    const parent = await ensurePatient("square");
    const spec = clone(ModelSpecSchema, plan.value.model!);
    try {
      const built = await buildModel(parent, spec, ({ fraction, stage }) =>
        progress(fraction, `Building the model: ${stage}`),
      );
      const meshes = await collectMeshes(patients.downloadModelMesh({ name: built.name }));
      setModel(built, meshes);
    } catch (error) {
      violations.value = toPlanFields(toProblem(error).violations, "model");
      throw error;
    }
  });
}

/** The plan as it goes to the daemon: on the model that was built. */
export function simulationSpec() {
  const spec = clone(PlanSchema, plan.value).simulation!;
  spec.model = model.value?.name ?? "";
  return spec;
}
