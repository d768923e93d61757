// Where the daemon places the zones of the plan: asked with a simulation that is made, looked at and taken away.
import { effect, signal } from "@preact/signals";
import { toJsonString } from "@bufbuild/protobuf";
import { SimulationSpecSchema } from "@wire/simulation_pb";
import { frames, newId, simulations } from "../api/client";
import { ArrayAssembler, toNumbers } from "../api/arrays";
import { toProblem } from "../api/errors";
import { simulationSpec } from "../plan/actions";
import { busy, modelIsCurrent, plan, violations } from "../plan/state";
import { toPlanFields } from "../plan/violations";
import { step } from "./stage_state";

/** Number of the zone under each vertex of the model's skin, from 1; 0: none. */
export const zonePreview = signal<Float32Array | undefined>(undefined);
const quietMs = 500;

async function readZones(simulation: string): Promise<Float32Array | undefined> {
  const leave = new AbortController();
  const assembler = new ArrayAssembler();
  try {
    for await (const { message } of frames.watch({ simulation, fields: ["skin.zone"] }, { signal: leave.signal })) {
      if (message.case !== "frame") continue;
      message.value.fields.forEach((field) => assembler.add(field));
      if (!message.value.last) continue;
      const zone = assembler.take().get("skin.zone");
      return zone && toNumbers(zone);
    }
  } finally {
    leave.abort();
  }
  return undefined;
}

async function ask(text: string): Promise<void> {
  const spec = simulationSpec();
  let name = "";
  try {
    name = (await simulations.createSimulation({ requestId: newId(), displayName: "check-of-a-plan", spec })).name;
    const zones = await readZones(name);
    if (text !== shown) return;
    zonePreview.value = zones;
    violations.value = [];
  } catch (error) {
    if (text === shown && !toProblem(error).lost)
      violations.value = toPlanFields(toProblem(error).violations, "simulation");
  } finally {
    // A check that cannot be taken away now goes with the daemon's own clearing up.
    if (name) await simulations.deleteSimulation({ name }).catch(() => undefined);
  }
}

let shown = "";

/** Asks again when the plan has been left alone for a moment. */
export function bindZonePreview(): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  return effect(() => {
    clearTimeout(timer);
    if (!modelIsCurrent.value) {
      zonePreview.value = undefined;
      shown = "";
      return;
    }
    const { simulation } = plan.value;
    if (step.value !== "fat" || busy.value || !simulation || !simulation.films.some(({ zones }) => zones.length > 0))
      return;
    const text = toJsonString(SimulationSpecSchema, simulation);
    if (text === shown) return;
    timer = setTimeout(() => {
      shown = text;
      void ask(text);
    }, quietMs);
  });
}
