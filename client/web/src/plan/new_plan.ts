// A plan to begin with: around the zones of the paper, three layers, nothing injected yet.
import { create } from "@bufbuild/protobuf";
import { PlanSchema, type Plan } from "@wire/plan_pb";
import { FilmSchema, InjectionSchema, ZoneSchema, type Film, type Injection, type Zone } from "@wire/simulation_pb";
import { Support_Kind, TissueLayer_Kind, TissuePreset } from "@wire/model_pb";
import { aroundOf } from "./anatomy";

export interface Resolution {
  key: string;
  label: string;
  /** absent: chosen for the zones when the model is built */
  nXi?: number;
  nEta?: number;
}

export const resolutions: Resolution[] = [
  { key: "chosen", label: "As the zones need, the slowest" },
  { key: "coarse", label: "Coarse, quickest", nXi: 24, nEta: 20 },
  { key: "standard", label: "Standard", nXi: 40, nEta: 32 },
  { key: "fine", label: "Fine, four times as long", nXi: 60, nEta: 48 },
];

const constant = (value: number) => ({ kind: { case: "constant" as const, value } });

export function newPlan(): Plan {
  return create(PlanSchema, {
    name: "plan",
    model: {
      geometry: { case: "scanRegion", value: { around: aroundOf("jaw_zones", "left") } },
      nXi: 40,
      nEta: 32,
      tissuePreset: TissuePreset.PAPER,
      layers: [
        { name: "skin", kind: TissueLayer_Kind.SKIN, thicknessMm: constant(1.8) },
        { name: "subcutaneous", kind: TissueLayer_Kind.SUBCUTANEOUS, thicknessMm: constant(3) },
        { name: "muscle", kind: TissueLayer_Kind.MUSCLE, thicknessMm: constant(8) },
      ],
      rim: { kind: Support_Kind.CLAMPED },
    },
    simulation: {
      fat: { viscosityPaS: 15 },
      films: [newFilm("deep", "subcutaneous")],
      time: { stepMs: 10, maxStepMs: 2000, endS: 120, settleSkinSpeedMmPerS: 0.01 },
    },
    output: { intervalMs: 1000 },
  });
}

/** Its cells are as narrow as the model's elements let them be. */
export function newFilm(name: string, belowLayer: string): Film {
  return create(FilmSchema, { name, belowLayer, restThicknessMm: constant(0.05) });
}

export function newZone(name: string, region: string): Zone {
  return create(ZoneSchema, { name, shape: { case: "region", value: region } });
}

export function newInjection(zone: string, volumeMl = 1, rateMlPerS = 1): Injection {
  return create(InjectionSchema, { zone, volumeMl, rateMlPerS });
}

/** `wanted`, or with a number behind it where that is taken. */
export function freeName(wanted: string, taken: string[]): string {
  if (!taken.includes(wanted)) return wanted;
  for (let k = 2; ; ++k) if (!taken.includes(`${wanted}_${k}`)) return `${wanted}_${k}`;
}

/** The cells of every film follow. */
export function setResolution(plan: Plan, { nXi, nEta }: Resolution): void {
  if (!plan.model || !plan.simulation) return;
  Object.assign(plan.model, { nXi, nEta });
  for (const film of plan.simulation.films) Object.assign(film, { nXi: undefined, nEta: undefined });
}
