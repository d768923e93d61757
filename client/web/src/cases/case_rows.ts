// The rows of the list of cases, from what the daemon has: patients, their plans, their runs.
import { Simulation_State, type Simulation } from "@wire/simulation_pb";
import { PlanSide, type SavedPlan } from "@wire/plan_service_pb";
import type { Patient } from "@wire/patient_service_pb";
import { isLive, ownerOf } from "../api/runs";

export type CaseState = "new" | "planned" | "running" | "done" | "changed" | "failed";

export const stateWords: Record<CaseState, string> = {
  new: "No plan yet",
  planned: "Planned",
  running: "Running",
  done: "Result",
  changed: "Changed since its run",
  failed: "Run failed",
};

export interface CaseRow {
  /** patients/{patient} */
  name: string;
  label: string;
  title: string;
  side: PlanSide;
  state: CaseState;
  plans: number;
  /** seconds since 1970 of the last change */
  changedS: number;
  /** of the face, for its picture; empty: none is known */
  scan: string;
}

export interface Wanted {
  search: string;
  side: PlanSide;
  state: CaseState | "";
  order: "date" | "name";
}

const secondsOf = (time: { seconds: bigint } | undefined): number => Number(time?.seconds ?? 0n);

function stateOf(plan: SavedPlan, runs: Map<string, Simulation>): CaseState {
  const newest = plan.runs[0];
  const run = newest && runs.get(newest.simulation);
  if (run === undefined) return "planned";
  if (isLive(run.state)) return "running";
  if (newest.contentHash !== plan.contentHash) return "changed";
  return run.state === Simulation_State.FAILED ? "failed" : "done";
}

/** Tells the state of a case by its newest run, where no saved plan names one (command line). */
function stateOfRun(run: Simulation): CaseState {
  if (isLive(run.state)) return "running";
  return run.state === Simulation_State.FAILED ? "failed" : "done";
}

/** A row a patient: its plan that was changed last speaks for it, without one its newest run. */
export function rowsOf(patients: Patient[], plans: SavedPlan[], simulations: Simulation[]): CaseRow[] {
  const runs = new Map(simulations.map((run) => [run.name, run]));
  const byOwner = new Map<string, SavedPlan[]>();
  for (const plan of plans) {
    const owner = ownerOf(plan.name);
    byOwner.set(owner, [...(byOwner.get(owner) ?? []), plan]);
  }
  const newestRun = new Map<string, Simulation>();
  for (const run of simulations) {
    const owner = ownerOf(run.spec?.model ?? "");
    const known = newestRun.get(owner);
    if (!known || secondsOf(run.createTime) > secondsOf(known.createTime)) newestRun.set(owner, run);
  }
  return patients.map((patient) => {
    const own = (byOwner.get(patient.name) ?? []).sort((a, b) => secondsOf(b.updateTime) - secondsOf(a.updateTime));
    const [plan] = own;
    const run = plan ? undefined : newestRun.get(patient.name);
    return {
      name: patient.name,
      label: patient.displayName || patient.name.split("/").pop()!,
      title: plan?.title ?? run?.displayName ?? "",
      side: plan?.side ?? PlanSide.PLAN_SIDE_UNSPECIFIED,
      state: plan ? stateOf(plan, runs) : run ? stateOfRun(run) : "new",
      plans: own.length,
      changedS: secondsOf(plan?.updateTime ?? run?.createTime ?? patient.createTime),
      scan: own.find(({ scan }) => scan !== "")?.scan ?? "",
    };
  });
}

/** What is searched for: every word stands somewhere in the row. */
export function chosen(rows: CaseRow[], { search, side, state, order }: Wanted): CaseRow[] {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  return rows
    .filter((row) => {
      const text = `${row.label} ${row.title} ${row.name} ${stateWords[row.state]}`.toLowerCase();
      return (
        words.every((word) => text.includes(word)) &&
        (side === PlanSide.PLAN_SIDE_UNSPECIFIED || row.side === side) &&
        (state === "" || row.state === state)
      );
    })
    .sort((a, b) => (order === "name" ? a.label.localeCompare(b.label) : b.changedS - a.changedS));
}

/** "today 14:05", "30 Nov 2026" */
export function dateWords(seconds: number, now = new Date()): string {
  const at = new Date(seconds * 1000);
  if (at.toDateString() === now.toDateString())
    return `today ${at.toLocaleTimeString("en-GB", { hour: "2-digit", minute: "2-digit" })}`;
  return at.toLocaleDateString("en-GB", { day: "numeric", month: "short", year: "numeric" });
}
