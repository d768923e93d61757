// The page's address: step, patient, plan, scan and run, so that a reload and the browser's way
// back come to the same.
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
}

const id = (name: string): string => name.split("/").pop()!;
const full = (folder: string, name: string | null): string =>
  name !== null && /^[a-z0-9-]{1,63}$/.test(name) ? `${folder}/${name}` : "";

/** "#plan/fat?patient=abc&plan=def&scan=ghi&run=jkl" */
export function writeAddress({ page, step, patient, plan, scan, run }: Address): string {
  if (page !== "plan") return `#${page}`;
  const parts = Object.entries({ patient, plan, scan, run }).flatMap(([key, name]) =>
    name === "" ? [] : [`${key}=${id(name)}`],
  );
  return `#plan/${step}${parts.length > 0 ? `?${parts.join("&")}` : ""}`;
}

/** What is not understood is left out: the page then begins as it would without. */
export function parseAddress(hash: string): Address {
  const [path, query = ""] = hash.replace(/^#/, "").split("?");
  const [page, step] = path.split("/");
  const names = new URLSearchParams(query);
  const patient = full("patients", names.get("patient"));
  return {
    page: page === "dashboard" || page === "cases" ? page : "plan",
    step: stepNames.find((name) => name === step) ?? "face",
    patient,
    plan: patient === "" ? "" : full(`${patient}/plans`, names.get("plan")),
    scan: patient === "" ? "" : full(`${patient}/scans`, names.get("scan")),
    run: full("simulations", names.get("run")),
  };
}
