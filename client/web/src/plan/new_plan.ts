// A plan to begin with: around the zones of the paper, three layers, nothing injected yet.
import { create } from "@bufbuild/protobuf";
import { PlanSchema, type Plan } from "@wire/plan_pb";
import { FilmSchema, InjectionSchema, ZoneSchema, type Film, type Injection, type Zone } from "@wire/simulation_pb";
import { Support_Kind, TissueLayer_Kind, TissuePreset } from "@wire/model_pb";
import { aroundOf } from "./anatomy";

export const resolutions = [
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
      base: { kind: Support_Kind.CLAMPED },
    },
    simulation: {
      fat: { viscosityPaS: 15 },
      films: [newFilm("deep", "subcutaneous", 40, 32)],
      time: { stepMs: 10, maxStepMs: 2000, endS: 120, settleSkinSpeedMmPerS: 0.01 },
    },
    output: { intervalMs: 1000 },
  });
}

export function newFilm(name: string, belowLayer: string, nXi: number, nEta: number): Film {
  return create(FilmSchema, {
    name,
    belowLayer,
    nXi: Math.floor(nXi / 2),
    nEta: Math.floor(nEta / 2),
    restThicknessMm: constant(0.05),
  });
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

/** Film cells span at least two hexahedra of the tissue. */
export function setResolution(plan: Plan, nXi: number, nEta: number): void {
  if (!plan.model || !plan.simulation) return;
  Object.assign(plan.model, { nXi, nEta });
  for (const film of plan.simulation.films) {
    const spanXi = (film.extent?.xiMax ?? 1) - (film.extent?.xiMin ?? 0);
    const spanEta = (film.extent?.etaMax ?? 1) - (film.extent?.etaMin ?? 0);
    film.nXi = Math.floor((spanXi * nXi) / 2 + 1e-9);
    film.nEta = Math.floor((spanEta * nEta) / 2 + 1e-9);
  }
}
