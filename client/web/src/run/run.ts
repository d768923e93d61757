// What is done with the simulation on the page: created from the plan, steered, watched; or one
// that is over, opened.
import { batch, computed } from "@preact/signals";
import { toJsonString } from "@bufbuild/protobuf";
import { Code, ConnectError } from "@connectrpc/connect";
import {
  SimulationSpecSchema,
  Simulation_State,
  type Injection,
  type SeriesRow,
  type Simulation,
} from "@wire/simulation_pb";
import { attempt, tell } from "../activity";
import { newId, simulations } from "../api/client";
import { toProblem } from "../api/errors";
import { watch, type Listener, type Seen } from "../api/watch";
import { keepPlan, noteRun } from "../case/keeper";
import { saved } from "../case/saved_plan";
import { build, simulationSpec } from "../plan/actions";
import { editPlan, model, modelIsCurrent, plan, violations } from "../plan/state";
import { toPlanFields } from "../plan/violations";
import {
  connection,
  distance,
  faceMesh,
  frame,
  isRunning,
  isUnderWay,
  lookedAt,
  meshes,
  planOfRun,
  readableMs,
  recorded,
  refusals,
  rows,
  runAxes,
  simulation,
  skipped,
  state,
  store,
  timeShown,
} from "./state";

let leave = new AbortController();
/** of the simulation that is shown, once its frames have ended */
let seen: Seen | undefined;
let following = Promise.resolve();
const pollMs = 400;
const mostRows = 20_000;

let figuresDue: ReturnType<typeof setTimeout> | undefined;

function showTime(atOnce: boolean): void {
  if (atOnce) {
    timeShown.value = frame.value?.timeS;
  } else {
    figuresDue ??= setTimeout(() => {
      figuresDue = undefined;
      timeShown.value = frame.value?.timeS;
    }, readableMs);
  }
}

const listener: Listener = {
  meshes: (next) => (meshes.value = next),
  connection: (next) => (connection.value = next),
  frame(next, skippedBefore) {
    if (frame.value !== undefined && next.epoch !== store.latest?.epoch) store.dropAfter(next.sequence - 1n);
    store.add(next);
    batch(() => {
      skipped.value += skippedBefore;
      if (lookedAt.value === undefined) frame.value = next;
    });
    showTime(next.end);
  },
};

/** The plan as a run would have it. */
export const runText = computed(() => {
  const { simulation: spec } = plan.value;
  return `${model.value?.name ?? ""} ${modelIsCurrent.value} ${spec ? toJsonString(SimulationSpecSchema, { ...spec, model: "" }) : ""}`;
});
/** The result is of another plan than the one on the page. */
export const planHasChanged = computed(() => planOfRun.value !== "" && planOfRun.value !== runText.value);

/** Forgets what is shown; the simulation itself goes on. */
export function close(): void {
  leave.abort();
  leave = new AbortController();
  seen = undefined;
  store.clear();
  batch(() => {
    [simulation.value, frame.value, meshes.value, lookedAt.value, recorded.value] = [
      undefined,
      undefined,
      undefined,
      undefined,
      "",
    ];
    [timeShown.value, runAxes.value, distance.value, planOfRun.value] = [undefined, undefined, undefined, ""];
    [rows.value, refusals.value, skipped.value, connection.value] = [[], [], 0, "idle"];
  });
}

async function follow(name: string, face: string): Promise<void> {
  const { signal: left } = leave;
  faceMesh.value = face;
  const fields = ["displacement", "pressure", "thickness"].map((field) => `${face}.${field}`);
  void poll(name, left);
  try {
    const until = await watch({ simulation: name, fields, maxRateHz: 60, seen, signal: left }, listener);
    if (!left.aborted) [seen, connection.value] = [until, "idle"];
  } catch (error) {
    const wrongField =
      ConnectError.from(error).code === Code.InvalidArgument || ConnectError.from(error).code === Code.NotFound;
    if (wrongField && face === "scan" && meshes.value === undefined) return follow(name, "skin");
    if (!left.aborted) tell(error);
  }
}

/** Figures and series, until the simulation is over and all of them are here. */
async function poll(name: string, left: AbortSignal): Promise<void> {
  for (;;) {
    try {
      const now = await simulations.getSimulation({ name }, { signal: left });
      let more = true;
      while (more && !left.aborted) {
        const afterStep = rows.value.at(-1)?.step ?? 0n;
        const response = await simulations.getSeries({ name, afterStep }, { signal: left });
        more = response.more;
        if (!left.aborted && response.rows.length > 0) rows.value = thinRows([...rows.value, ...response.rows]);
      }
      if (left.aborted) return;
      simulation.value = now;
      if (!isUnderWay.value) return;
    } catch (error) {
      if (left.aborted) return;
      if (!toProblem(error).lost) return tell(error);
      connection.value = "lost";
    }
    await new Promise((resolve) => setTimeout(resolve, pollMs));
  }
}

/**
 * In the order of time, coarser where there are too many; a return to an earlier state takes later
 * rows away.
 */
function thinRows(all: SeriesRow[]): SeriesRow[] {
  return all.length <= mostRows ? all : all.filter((_, index) => index % 2 === 0 || index === all.length - 1);
}

/** Shows a simulation of the daemon. */
export function open(next: Simulation, face = "scan"): void {
  close();
  simulation.value = next;
  following = follow(next.name, face);
}

const planFace = (): string => (plan.value.model?.geometry.case === "scanRegion" ? "scan" : "skin");

/** The plan as a simulation that waits for its start. Violations go beside their fields. */
export async function create(start: boolean): Promise<boolean> {
  violations.value = [];
  return attempt("Setting up the simulation", async () => {
    const displayName = plan.value.name
      .toLowerCase()
      .replace(/[^a-z0-9]+/g, "-")
      .slice(0, 63);
    await keepPlan(true);
    const [of, text, spec] = [saved.value, runText.value, simulationSpec()];
    try {
      const made = await simulations.createSimulation({ requestId: newId(), displayName, spec, start });
      open(made, planFace());
      planOfRun.value = text;
      await noteRun(made.name, of);
    } catch (error) {
      violations.value = toPlanFields(toProblem(error).violations, "simulation");
      throw error;
    }
  });
}

type Command = "startSimulation" | "pauseSimulation" | "resumeSimulation" | "stopSimulation";

export async function command(which: Command): Promise<void> {
  const name = simulation.value?.name;
  if (name === undefined) return;
  try {
    simulation.value = await simulations[which]({ name, requestId: newId() });
  } catch (error) {
    tell(error);
  }
}

/** What was injected live is the plan's as well, as long as that is the plan of the run. */
async function recordInjection({ name, spec }: Simulation): Promise<void> {
  if (spec === undefined || planOfRun.value === "" || planHasChanged.value) return;
  editPlan(({ simulation: into }) => (into!.injections = spec.injections));
  planOfRun.value = runText.value;
  await keepPlan();
  await noteRun(name, saved.value);
}

/** A simulation that has settled goes on with the injection, and is followed again. */
export async function inject(injection: Injection): Promise<boolean> {
  refusals.value = [];
  const { name } = simulation.value!;
  const over = !isUnderWay.value;
  const { signal: left } = leave;
  try {
    const now = await simulations.inject({ name, injection, requestId: newId() });
    if (left.aborted) return true;
    void recordInjection(now);
    simulation.value = now;
    if (over) following = following.then(() => (left.aborted ? undefined : follow(name, faceMesh.value)));
    return true;
  } catch (error) {
    refusals.value = toProblem(error).violations;
    tell(error);
    return false;
  }
}

/** Runs the plan of the page. */
export async function run(): Promise<void> {
  if (await build()) await create(true);
}

/** Runs the plan, or goes on with what is under way. */
export async function runOrPause(): Promise<void> {
  if (isRunning.value) return command("pauseSimulation");
  if (state.value === Simulation_State.PAUSED) return command("resumeSimulation");
  if (modelIsCurrent.value) await create(true);
}

/**
 * Looks at the frame at or before a simulated time; undefined: follows the newest. The moment that
 * is looked at is that of the frame: a slider stops between frames as well.
 */
export function lookAt(timeS: number | undefined): void {
  batch(() => {
    frame.value = timeS === undefined ? store.latest : store.at(timeS);
    lookedAt.value = timeS === undefined ? undefined : frame.value?.timeS;
    showTime(true);
  });
}
