// Makes a target, opens one that was made, and measures what the face lacks to it.
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { batch } from "@preact/signals";
import type { Scan } from "@wire/patient_service_pb";
import { FaceSurface_Placement, TargetSchema, TargetSpecSchema } from "@wire/planning_service_pb";
import { attempt } from "../activity";
import { newId, patients, planning } from "../api/client";
import { collectMeshes } from "../api/meshes";
import { finish } from "../api/long_work";
import { uploadScan } from "../api/upload";
import { patient, region, scan } from "../plan/state";
import {
  deficit,
  earlierTargets,
  forgetTarget,
  goalView,
  landmarksText,
  measuredWith,
  target,
  targetMesh,
  wanted,
} from "./state";

type Tell = Parameters<Parameters<typeof attempt>[1]>[0];
type Source = MessageInitShape<typeof TargetSpecSchema>["source"];

const landmarks = () => region.value?.landmarksMm ?? {};

async function measure(): Promise<void> {
  const [face, of, text] = [scan.value!, target.value!, landmarksText.value];
  const found = await planning.measureDeficit({ scan: face.name, landmarksMm: landmarks(), targetScan: of.name });
  // The page may be at another face by now.
  if (scan.value !== face || target.value !== of) return;
  [deficit.value, measuredWith.value] = [found, text];
}

/** Shows a goal, and what the face lacks to it. */
export async function showTarget(next: Scan): Promise<void> {
  const meshes = await collectMeshes(patients.downloadScanMesh({ name: next.name }));
  batch(() => {
    forgetTarget();
    [target.value, targetMesh.value] = [next, meshes.get("scan")];
  });
  await measure();
}

/** Targets in the frame of the face on the page, the newest first. */
export async function listTargets(): Promise<void> {
  const face = scan.value?.name;
  if (face === undefined || patient.value === "") return void (earlierTargets.value = []);
  const { scans } = await patients.listScans({ parent: patient.value, pageSize: 1000 });
  if (scan.value?.name !== face) return;
  earlierTargets.value = scans
    .filter(({ complete, report }) => complete && report?.target?.scan === face)
    .sort((a, b) => Number((b.createTime?.seconds ?? 0n) - (a.createTime?.seconds ?? 0n)));
}

async function make(source: Source, tell: Tell, left: AbortSignal): Promise<void> {
  const spec = create(TargetSpecSchema, { scan: scan.value!.name, landmarksMm: landmarks(), source });
  const made = await finish(
    await planning.makeTarget({ requestId: newId(), parent: patient.value, spec }),
    TargetSchema,
    ({ fraction, stage }) => tell(fraction, `Making the goal: ${stage}`),
    left,
  );
  tell(undefined, "Measuring what is missing");
  await showTarget(await patients.getScan({ name: made.scan }));
  await listTargets();
}

/** The healthy side, mirrored onto the other. */
export function mirrorHealthySide(): Promise<boolean> {
  const { healthySide } = wanted.value;
  return attempt(
    "Making the goal",
    (tell, left) => make({ case: "mirrored", value: { healthySide } }, tell, left),
    true,
  );
}

/** A surface of the same face from a file; it becomes a scan of the same patient. */
export function takeSurface(fileName: string, content: ArrayBuffer): Promise<boolean> {
  const { unit, inPlace } = wanted.value;
  return attempt(
    `Sending ${fileName}`,
    async (tell, left) => {
      const sent = await uploadScan(patient.value, fileName, content, unit, (share) => tell(share));
      const placement = inPlace ? FaceSurface_Placement.IN_PLACE : FaceSurface_Placement.REGISTERED;
      try {
        left.throwIfAborted();
        await make({ case: "surface", value: { scan: sent.name, placement } }, tell, left);
      } catch (error) {
        // What was refused leaves nothing behind.
        await patients.deleteScan({ name: sent.name }).catch(() => undefined);
        throw error;
      }
    },
    true,
  );
}

export function openTarget(next: Scan): Promise<boolean> {
  return attempt("Measuring what is missing", () => showTarget(next));
}

/** With the landmarks as they are now. */
export function measureAgain(): Promise<boolean> {
  goalView.value = "missing";
  return attempt("Measuring what is missing", measure);
}
