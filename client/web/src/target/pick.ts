// A point of a proposal's curve as a plan.
import { clone } from "@bufbuild/protobuf";
import type { Proposal, TradeOff } from "@wire/planning_service_pb";
import { SimulationSpecSchema, type SimulationSpec } from "@wire/simulation_pb";
import { newInjection } from "../plan/new_plan";

const mlStep = 1000;
const rounded = (volumeMl: number): number => Math.round(volumeMl * mlStep) / mlStep;

/** Seconds that the injections take one after the other, as the proposal counts them. */
function durationS({ injections }: SimulationSpec): number {
  return injections.reduce(
    (sum, { volumeMl, rateMlPerS }) => sum + Math.abs(volumeMl ?? 0) / Math.max(1e-9, rateMlPerS ?? 1),
    0,
  );
}

/** The volumes of a zone's injections, in proportion to what they were. */
function shareOut(plan: SimulationSpec, zone: string, volumeMl: number): void {
  const own = plan.injections.filter((injection) => injection.zone === zone);
  const before = own.reduce((sum, injection) => sum + (injection.volumeMl ?? 0), 0);
  if (own.length === 0 && volumeMl !== 0) plan.injections.push(newInjection(zone, volumeMl));
  for (const injection of own)
    injection.volumeMl =
      before === 0 ? volumeMl / own.length : rounded((volumeMl * (injection.volumeMl ?? 0)) / before);
}

/** The plan that was proposed with the volumes of another point; that of the proposal as it is. */
export function planOf(proposal: Proposal, point: number): SimulationSpec {
  const plan = clone(SimulationSpecSchema, proposal.plan!);
  plan.model = "";
  if (point === proposal.proposedPoint) return plan;
  const { volumes } = proposal.curve[point];
  for (const { zone, volumeMl } of volumes) shareOut(plan, zone, rounded(volumeMl));
  plan.injections = plan.injections.filter(({ volumeMl }) => volumeMl !== 0);
  if (plan.time) plan.time.endS = Math.max(plan.time.endS ?? 0, Math.ceil(durationS(plan)) + 1);
  return plan;
}

/** "3.0 mL" of a point, by zone and plane. */
export const totalOf = ({ totalMl }: TradeOff): string => `${totalMl.toFixed(1)} mL`;
