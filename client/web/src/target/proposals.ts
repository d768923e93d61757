// Asks for a plan that brings the skin near the target, and takes a point of what came into the
// plan.
import { create } from "@bufbuild/protobuf";
import { signal } from "@preact/signals";
import {
  ProposalBoundsSchema,
  ProposalSchema,
  ProposalSpecSchema,
  TissueSpreadSchema,
  ZoneProposalsSchema,
  type ProposalSpec,
} from "@wire/planning_service_pb";
import { attempt } from "../activity";
import { newId, planning } from "../api/client";
import { toProblem, type Violation } from "../api/errors";
import { finish } from "../api/long_work";
import { simulationSpec } from "../plan/actions";
import { editPlan, model, patient, violations } from "../plan/state";
import { mmHgPerPa } from "../scene/colour_maps";
import { showPlanShape } from "../shape/plan_volumes";
import { planOf } from "./pick";
import { picked, planText, proposal, target } from "./state";

/** Bounds in the units of a clinic; absent: none. */
export interface Bounds {
  maxTotalMl?: number;
  maxZoneMl?: number;
  maxPressureMmHg?: number;
  maxLiftMm?: number;
}

export interface Question extends Bounds {
  /** zones may be added where something is missing */
  addZones: boolean;
  /** layer below which they may lie; empty: any */
  belowLayer: string;
  /** the pressure stays below this in 95 of 100 cases of tissue [mmHg] */
  holdsBelowMmHg?: number;
}

export const question = signal<Question>({ addZones: true, belowLayer: "" });

const pa = (mmHg: number | undefined): number | undefined => (mmHg === undefined ? undefined : mmHg / mmHgPerPa);

export function proposalSpec({
  addZones,
  belowLayer,
  holdsBelowMmHg,
  maxTotalMl,
  maxZoneMl,
  maxPressureMmHg,
  maxLiftMm,
}: Question): ProposalSpec {
  const spec = create(ProposalSpecSchema, {
    plan: simulationSpec(),
    targetScan: target.value?.name ?? "",
    bounds: create(ProposalBoundsSchema, { maxTotalMl, maxZoneMl, maxLiftMm, maxPressurePa: pa(maxPressureMmHg) }),
  });
  if (addZones) spec.zones = create(ZoneProposalsSchema, { belowLayers: belowLayer === "" ? [] : [belowLayer] });
  // Planes without a zone are for those that are proposed, which bring their own.
  if (addZones) spec.plan!.films = spec.plan!.films.filter(({ zones }) => zones.length > 0);
  if (holdsBelowMmHg !== undefined) spec.spread = create(TissueSpreadSchema, { pressureBandPa: pa(holdsBelowMmHg)! });
  return spec;
}

/** What is said of the request's plan is said of the page's; the rest is beside its question. */
function toFields(all: Violation[]): Violation[] {
  return all.map(({ field, description }) => ({
    field: field.replace(/^spec\.plan(?=\.|$)/, "simulation").replace(/^spec(?=\.|$)/, "proposal"),
    description,
  }));
}

/** A proposal becomes the plan; another point of its curve can be picked then. */
export async function propose(): Promise<boolean> {
  violations.value = [];
  const [of, on] = [target.value, model.value];
  return attempt(
    "Looking for volumes",
    async (tell, left) => {
      try {
        const found = await finish(
          await planning.proposePlan({
            requestId: newId(),
            parent: patient.value,
            spec: proposalSpec(question.value),
          }),
          ProposalSchema,
          ({ fraction, stage }) => tell(fraction, `Looking for volumes: ${stage}`),
          left,
        );
        if (target.value !== of || model.value !== on) return;
        proposal.value = found;
        pick(found.proposedPoint);
      } catch (error) {
        violations.value = toFields(toProblem(error).violations);
        throw error;
      }
    },
    true,
  );
}

/** The plan has the volumes of this point from now on, and the picture its shape. */
export function pick(point: number): void {
  const from = proposal.value!;
  editPlan((next) => (next.simulation = planOf(from, point)));
  picked.value = { point, planText: planText.value };
  showPlanShape();
}
