// What the daemon says of the plan on its model: where the zones are, what is wrong, what is worth
// knowing.
import { batch, effect, signal } from "@preact/signals";
import { toJsonString } from "@bufbuild/protobuf";
import { SimulationSpecSchema } from "@wire/simulation_pb";
import type { PlacedZone } from "@wire/simulation_service_pb";
import { busy } from "../activity";
import { simulations } from "../api/client";
import { toProblem, type Violation } from "../api/errors";
import { simulationSpec } from "./actions";
import { modelIsCurrent, plan, violations } from "./state";
import { toPlanFields } from "./violations";

export const placedZones = signal<PlacedZone[]>([]);
/** Number of the zone under each vertex of the model's skin, from 1; 0: none. */
export const zoneUnderSkin = signal<number[]>([]);
export const remarks = signal<Violation[]>([]);
const quietMs = 500;

let leave = new AbortController();
let asked = "";

/** Forgets the last answer, and the question that may be on its way. */
function forget(): void {
  leave.abort();
  asked = "";
  batch(() => {
    [placedZones.value, zoneUnderSkin.value, remarks.value] = [[], [], []];
  });
}

async function ask(text: string): Promise<void> {
  leave.abort();
  leave = new AbortController();
  const { signal: left } = leave;
  asked = text;
  try {
    const answer = await simulations.checkPlan({ spec: simulationSpec() }, { signal: left });
    if (left.aborted) return;
    batch(() => {
      placedZones.value = answer.zones;
      zoneUnderSkin.value = answer.zoneUnderSkinPoint;
      remarks.value = toPlanFields(answer.remarks, "simulation");
      violations.value = toPlanFields(answer.violations, "simulation");
    });
  } catch (error) {
    if (left.aborted) return;
    // A lost connection says nothing of the plan.
    if (toProblem(error).lost) asked = "";
    else violations.value = toPlanFields(toProblem(error).violations, "simulation");
  }
}

/** Asks when the plan has been left alone for a moment, while `wanted` says so. */
export function bindPlanCheck(wanted: () => boolean): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  return effect(() => {
    clearTimeout(timer);
    if (!modelIsCurrent.value) return forget();
    const { simulation } = plan.value;
    if (!wanted() || busy.value || !simulation?.films.some(({ zones }) => zones.length > 0)) return;
    const text = toJsonString(SimulationSpecSchema, simulation);
    if (text !== asked) timer = setTimeout(() => void ask(text), quietMs);
  });
}
