// The face of the page: whose it is, and that nothing of another one stays when it changes.
import { batch } from "@preact/signals";
import { clone } from "@bufbuild/protobuf";
import type { Scan } from "@wire/patient_service_pb";
import { PlanSchema, ScanUnit } from "@wire/plan_pb";
import { attempt, problem, remark } from "../activity";
import { collectMeshes } from "../api/meshes";
import type { Mesh } from "../api/meshes";
import { patients } from "../api/client";
import { uploadScan } from "../api/upload";
import { leaveOtherFace } from "../plan/actions";
import { newPlan } from "../plan/new_plan";
import { createPatient } from "../plan/patient";
import { removePlaces } from "../plan/places";
import { patient, patientName, plan, scan, scanFile, scanMesh, setModel, startPlan, violations } from "../plan/state";
import { liveSite, tool } from "../plan/tools";
import { close as closeRun } from "../run/run";
import { forgetShape } from "../shape/finder";
import { forgetGoal } from "../target/state";
import { leavePlan } from "./keeper";

export interface Owner {
  name: string;
  displayName: string;
}

export async function loadMesh(of: Scan): Promise<Mesh> {
  const mesh = (await collectMeshes(patients.downloadScanMesh({ name: of.name }))).get("scan");
  if (mesh === undefined) throw new Error("the scan came without its surface");
  return mesh;
}

/** What was of the face before. */
function leaveFace(): void {
  leavePlan();
  closeRun();
  forgetShape();
  forgetGoal();
  setModel(undefined, undefined);
  [tool.value, liveSite.value, violations.value] = [{ kind: "turn" }, undefined, []];
}

const isSameSurface = (one: Scan | undefined, other: Scan): boolean =>
  one !== undefined && one.sha256 !== "" && one.sha256 === other.sha256 && one.unit === other.unit;

/**
 * Another face on the page. The plan goes along without all that lies on one face only: landmarks,
 * what was drawn and painted. On the same surface everything stays.
 */
export function showFace(owner: Owner, next: Scan, mesh: Mesh, file: { name: string; unit: ScanUnit }): void {
  batch(() => {
    const [before, same] = [scan.value, isSameSurface(scan.value, next)];
    leaveFace();
    [patient.value, patientName.value] = [owner.name, owner.displayName];
    [scan.value, scanMesh.value, scanFile.value] = [next, mesh, file];
    const kept = clone(PlanSchema, plan.value);
    if (before === undefined) leaveOtherFace(kept);
    else if (!same) removePlaces(kept);
    if (kept.model?.geometry.case === "scanRegion") kept.model.geometry.value.scan = next.name;
    startPlan(kept);
  });
}

/** An empty page, as for a new patient. */
export function closeCase(): void {
  batch(() => {
    leaveFace();
    [patient.value, patientName.value, remark.value, problem.value] = ["", "", "", undefined];
    [scan.value, scanMesh.value] = [undefined, undefined];
    scanFile.value = { name: "", unit: ScanUnit.MILLIMETRE };
    startPlan(newPlan());
  });
}

/** The page of a patient whose face is still to come. */
export function beginCase(owner: Owner): void {
  batch(() => {
    closeCase();
    [patient.value, patientName.value] = [owner.name, owner.displayName];
  });
}

/** Sends a scan to a patient, or to a new one, who goes again when the scan is refused. */
async function send(
  owner: Owner | undefined,
  fileName: string,
  content: ArrayBuffer,
  unit: ScanUnit,
  tell: (share: number, label?: string) => void,
): Promise<void> {
  const of = owner ?? (await createPatient());
  try {
    const made = await uploadScan(of.name, fileName, content, unit, (share) => tell(share));
    tell(1, "Loading the face");
    showFace(of, made, await loadMesh(made), { name: fileName, unit });
  } catch (error) {
    if (owner === undefined) await patients.deletePatient({ name: of.name, force: true }).catch(() => undefined);
    throw error;
  }
}

/** A scan of somebody who is new here. */
export function uploadFace(fileName: string, content: ArrayBuffer, unit: ScanUnit): Promise<boolean> {
  return attempt(`Sending ${fileName}`, (tell) => {
    remark.value = "";
    return send(undefined, fileName, content, unit, tell);
  });
}

/** Another scan of the patient on the page. */
export function uploadAnother(fileName: string, content: ArrayBuffer, unit: ScanUnit): Promise<boolean> {
  const owner = { name: patient.value, displayName: patientName.value };
  return attempt(`Sending ${fileName}`, (tell) => {
    remark.value = "";
    return send(owner, fileName, content, unit, tell);
  });
}
