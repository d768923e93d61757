// Rows of the list of cases.
import { create } from "@bufbuild/protobuf";
import { PatientSchema } from "@wire/patient_service_pb";
import { PlanSide, SavedPlanSchema } from "@wire/plan_service_pb";
import { Simulation_State, SimulationSchema } from "@wire/simulation_pb";
import { describe, expect, it } from "vitest";
import { chosen, rowsOf } from "../../src/cases/case_rows";

const time = (seconds: number) => ({ seconds: BigInt(seconds) });
const patient = (name: string, displayName = "") =>
  create(PatientSchema, { name: `patients/${name}`, displayName, createTime: time(1) });
const run = (name: string, of: string, state: Simulation_State, atS: number) =>
  create(SimulationSchema, {
    name: `simulations/${name}`,
    displayName: `run-${name}`,
    state,
    createTime: time(atS),
    spec: { model: `patients/${of}/models/m` },
  });

describe("a case", () => {
  it("that the command line made is told by its newest run", () => {
    const runs = [
      run("a", "p", Simulation_State.SETTLED, 5),
      run("b", "p", Simulation_State.RUNNING, 9),
      run("c", "q", Simulation_State.FAILED, 7),
      run("d", "r", Simulation_State.FINISHED, 8),
    ];
    const rows = rowsOf([patient("p", "case-1"), patient("q"), patient("r"), patient("s")], [], runs);
    expect(rows.map(({ label, title, state, changedS }) => [label, title, state, changedS])).toEqual([
      ["case-1", "run-b", "running", 9],
      ["q", "run-c", "failed", 7],
      ["r", "run-d", "done", 8],
      ["s", "", "new", 1],
    ]);
  });

  it("with a plan is told by the plan, whatever else was run", () => {
    const plan = create(SavedPlanSchema, {
      name: "patients/p/plans/1",
      title: "left cheek",
      side: PlanSide.LEFT_SIDE,
      scan: "patients/p/scans/s",
      updateTime: time(20),
    });
    const [row] = rowsOf([patient("p")], [plan], [run("a", "p", Simulation_State.SETTLED, 30)]);
    expect(row).toMatchObject({ title: "left cheek", state: "planned", scan: "patients/p/scans/s", changedS: 20 });
  });

  it("is found by its state, and by words of its run", () => {
    const rows = rowsOf([patient("p"), patient("q")], [], [run("a", "q", Simulation_State.SETTLED, 5)]);
    const nothing = { search: "", side: PlanSide.PLAN_SIDE_UNSPECIFIED, state: "", order: "date" } as const;
    expect(chosen(rows, { ...nothing, state: "done" }).map(({ label }) => label)).toEqual(["q"]);
    expect(chosen(rows, { ...nothing, search: "run-a" }).map(({ label }) => label)).toEqual(["q"]);
  });
});
