// The plan under work, kept in this tab: the daemon has scans, models and runs, but not what was
// not run yet.
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
