// The page's address: step, patient, plan, scan and run, where the face is looked at from and when,
// so that a reload and the browser's way back come to the same.
import type { Point } from "../scene/surface_geometry";
import type { CameraPose } from "../scene/viewport";
import { stepNames, type Step } from "../stage/stage_state";

export interface Address {
  page: "plan" | "cases" | "dashboard";
  step: Step;
  /** patients/{patient}; empty: none */
  patient: string;
  /** patients/{patient}/plans/{plan}; empty: none that is kept */
  plan: string;
  /** patients/{patient}/scans/{scan}; empty: none */
  scan: string;
  /** simulations/{simulation}; empty: none */
  run: string;
  /** as somebody has turned the face; absent: as the page looks at it */
  camera?: CameraPose;
  /** the moment of the run that is looked at; absent: the newest */
  momentS?: number;
}

const id = (name: string): string => name.split("/").pop()!;
const full = (folder: string, name: string | null): string =>
  name !== null && /^[a-z0-9-]{1,63}$/.test(name) ? `${folder}/${name}` : "";

const farthestMm = 1e7;

/** Position, focus and upwards, "x,y,z,x,y,z,x,y,z": tenths of a millimetre are seen by nobody. */
const writeCamera = ({ position, focus, up }: CameraPose): string =>
  [...[...position, ...focus].map((v) => v.toFixed(1)), ...up.map((v) => v.toFixed(3))].join(",");

function parseCamera(text: string | null): CameraPose | undefined {
  const v = (text ?? "").split(",").map((word) => (word.trim() === "" ? NaN : Number(word)));
  if (v.length !== 9 || !v.every((value) => Math.abs(value) < farthestMm)) return undefined;
  const [position, focus, up] = [v.slice(0, 3), v.slice(3, 6), v.slice(6)] as [Point, Point, Point];
  const apart = (a: Point, b: Point): number => Math.hypot(...a.map((x, c) => x - b[c]));
  return apart(position, focus) < 1 || Math.hypot(...up) < 0.5 ? undefined : { position, focus, up };
}

/** "#plan/fat?patient=abc&plan=def&scan=ghi&run=jkl&camera=0.0,...&at=2.50" */
export function writeAddress({ page, step, patient, plan, scan, run, camera, momentS }: Address): string {
  if (page !== "plan") return `#${page}`;
  const parts = Object.entries({ patient, plan, scan, run }).flatMap(([key, name]) =>
    name === "" ? [] : [`${key}=${id(name)}`],
  );
  if (camera) parts.push(`camera=${writeCamera(camera)}`);
  if (momentS !== undefined && run !== "") parts.push(`at=${momentS.toFixed(2)}`);
  return `#plan/${step}${parts.length > 0 ? `?${parts.join("&")}` : ""}`;
}

/** What is not understood is left out: the page then begins as it would without. */
export function parseAddress(hash: string): Address {
  const [path, query = ""] = hash.replace(/^#/, "").split("?");
  const [page, step] = path.split("/");
  const names = new URLSearchParams(query);
  const patient = full("patients", names.get("patient"));
  const moment = Number(names.get("at") ?? NaN);
  return {
    page: page === "dashboard" || page === "cases" ? page : "plan",
    step: stepNames.find((name) => name === step) ?? "face",
    patient,
    plan: patient === "" ? "" : full(`${patient}/plans`, names.get("plan")),
    scan: patient === "" ? "" : full(`${patient}/scans`, names.get("scan")),
    run: full("simulations", names.get("run")),
    camera: parseCamera(names.get("camera")),
    momentS: moment >= 0 && moment < Infinity ? moment : undefined,
  };
}
