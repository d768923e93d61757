// The plan under work, in this tab: what the daemon does not have, as it could not be reached or
// the page was left in the middle of a change, and the plan of a page without a patient.
import { fromJsonString, toJsonString } from "@bufbuild/protobuf";
import { PlanSchema, ScanUnit, type Plan } from "@wire/plan_pb";

export interface Kept {
  plan: Plan;
  /** patients/{patient}/scans/{scan} that the plan is on; empty: none */
  scan: string;
  file: { name: string; unit: ScanUnit };
  /** the model that was built, and what it was built from */
  model: string;
  builtFrom: string;
  /** the goal that was open */
  target: string;
  /** the plan that the run is of */
  planOfRun: string;
  /** patients/{patient}/plans/{plan} that the daemon keeps, and the etag last heard of it */
  saved: string;
  etag: string;
  /** there is something that the daemon has yet to keep */
  hasNews: boolean;
}

const keyOf = (patient: string): string => `lipofill.plan.${patient || "new"}`;

/** Where a tab has no room left, the plan is not kept: the page goes on as it is. */
export function keep(patient: string, { plan, ...rest }: Kept): void {
  try {
    sessionStorage.setItem(keyOf(patient), JSON.stringify({ ...rest, plan: toJsonString(PlanSchema, plan) }));
  } catch {
    sessionStorage.removeItem(keyOf(patient));
  }
}

/** What another version of the page has kept may not be understood: then there is nothing. */
export function recall(patient: string): Kept | undefined {
  const text = sessionStorage.getItem(keyOf(patient));
  if (text === null) return undefined;
  try {
    const { plan, ...rest } = JSON.parse(text) as Omit<Kept, "plan"> & { plan: string };
    return { ...rest, plan: fromJsonString(PlanSchema, plan) };
  } catch {
    return undefined;
  }
}
