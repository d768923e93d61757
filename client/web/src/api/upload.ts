// Scans, on their way to the daemon, a chunk a call: an upload that broke off goes on where it
// stopped.
import type { DescMethodUnary } from "@bufbuild/protobuf";
import {
  PatientService,
  ScanFormat,
  type Scan,
  type UploadScanRequestSchema,
  type ScanSchema,
} from "@wire/patient_service_pb";
import type { ScanUnit } from "@wire/plan_pb";
import { create } from "@bufbuild/protobuf";
import { UploadScanRequestSchema as RequestSchema } from "@wire/patient_service_pb";
import { newId, patients, transport } from "./client";
import { isLost } from "./errors";

const chunkBytes = 1 << 20;
const mostRetries = 5;

// Browsers cannot stream a request; a stream of one message is on the wire what a unary call is.
const uploadChunk = { ...PatientService.method.uploadScan, methodKind: "unary" } as unknown as DescMethodUnary<
  typeof UploadScanRequestSchema,
  typeof ScanSchema
>;

export function formatOf(fileName: string): ScanFormat {
  const ending = fileName.toLowerCase().split(".").pop();
  const formats: Record<string, ScanFormat> = { obj: ScanFormat.OBJ, ply: ScanFormat.PLY, stl: ScanFormat.STL };
  const format = formats[ending ?? ""];
  if (format === undefined) throw new Error(`'${fileName}' is no scan: its name must end in .obj, .ply or .stl`);
  return format;
}

async function sha256(bytes: Uint8Array<ArrayBuffer>): Promise<string> {
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes));
  return Array.from(digest, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

async function send(name: string, offset: number, data: Uint8Array): Promise<Scan> {
  const response = await transport.unary(
    uploadChunk,
    undefined,
    undefined,
    undefined,
    create(RequestSchema, { name, offset: BigInt(offset), data }),
  );
  return response.message;
}

/**
 * Nothing stays of a file that is refused.
 * @param progress told the share that has arrived, 0 to 1
 */
export async function uploadScan(
  parent: string,
  fileName: string,
  content: ArrayBuffer,
  unit: ScanUnit,
  progress: (share: number) => void,
): Promise<Scan> {
  const bytes = new Uint8Array(content);
  const format = formatOf(fileName);
  let scan = await patients.createScan({
    requestId: newId(),
    parent,
    format,
    unit,
    sizeBytes: BigInt(bytes.length),
    sha256: await sha256(bytes),
  });
  let offset = 0;
  for (let retries = 0; !scan.complete; ) {
    try {
      scan = await send(scan.name, offset, bytes.subarray(offset, offset + chunkBytes));
      retries = 0;
    } catch (error) {
      if (!isLost(error)) await patients.deleteScan({ name: scan.name }).catch(() => undefined);
      if (!isLost(error) || ++retries > mostRetries) throw error;
      await new Promise((resolve) => setTimeout(resolve, 500 * retries));
      scan = await patients.getScan({ name: scan.name });
    }
    offset = Number(scan.receivedBytes);
    progress(bytes.length === 0 ? 1 : offset / bytes.length);
  }
  return scan;
}
