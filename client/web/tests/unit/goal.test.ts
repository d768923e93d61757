// A point of a proposal's curve as a plan, the injection list as a table, the colours of what is
// missing.
import { create } from "@bufbuild/protobuf";
import { DeliverySchema, ProposalSchema } from "@wire/planning_service_pb";
import { describe, expect, it, vi } from "vitest";

vi.hoisted(() => {
  Object.assign(globalThis, {
    location: { origin: "http://here", hash: "" },
    sessionStorage: { getItem: () => null, setItem: () => undefined },
  });
});

const { newInjection, newPlan, newZone } = await import("../../src/plan/new_plan");
const { deficitMap } = await import("../../src/scene/deficit_map");
const { tunnelsOf, writeDelivery } = await import("../../src/target/delivery");
const { planOf } = await import("../../src/target/pick");

const volumes = (...all: [string, number][]) => all.map(([zone, volumeMl]) => ({ zone, volumeMl, pressurePa: 500 }));

function proposal() {
  const plan = newPlan().simulation!;
  plan.model = "patients/a/models/b";
  plan.films[0].zones = [newZone("deep", "masseter_left"), newZone("low", "chin_left")];
  plan.injections = [newInjection("deep", 2), newInjection("deep", 1)];
  plan.time!.endS = 5;
  return create(ProposalSchema, {
    plan,
    proposedPoint: 1,
    curve: [
      { totalMl: 1.5, volumes: volumes(["deep", 1.5], ["low", 0]) },
      { totalMl: 3, volumes: volumes(["deep", 3], ["low", 0]) },
      { totalMl: 10, volumes: volumes(["deep", 6], ["low", 4]) },
      { totalMl: 1, volumes: volumes(["deep", 0], ["low", 1]) },
    ],
  });
}
const injected = (point: number) => planOf(proposal(), point).injections.map(({ zone, volumeMl }) => [zone, volumeMl]);

describe("a point of the curve", () => {
  it("is the plan as it was proposed, without the name of a model", () => {
    expect(injected(1)).toEqual([
      ["deep", 2],
      ["deep", 1],
    ]);
    expect(planOf(proposal(), 1).model).toBe("");
  });
  it("has the volumes of its zones, shared out as they were", () => {
    expect(injected(0)).toEqual([
      ["deep", 1],
      ["deep", 0.5],
    ]);
    expect(injected(2)).toEqual([
      ["deep", 4],
      ["deep", 2],
      ["low", 4],
    ]);
  });
  it("injects nothing into a zone that takes nothing", () => expect(injected(3)).toEqual([["low", 1]]));
  it("goes on for as long as its injections take", () => {
    expect(planOf(proposal(), 2).time!.endS).toBe(11);
    expect(planOf(proposal(), 0).time!.endS).toBe(5);
  });
});

const list = create(DeliverySchema, {
  entries: [
    { zone: "deep", belowLayer: "skin" },
    { zone: "low", belowLayer: "smas" },
  ],
  passes: [
    { entry: 0, tunnel: 0, volumeMl: 0.1, pathMm: [{ x: 1, y: 2, z: 3 }, { x: 4 }] },
    { entry: 0, tunnel: 0, volumeMl: 0.1, pathMm: [{ x: 1, y: 2, z: 3 }, { x: 4 }] },
    { entry: 0, tunnel: 1, volumeMl: 0.05, pathMm: [] },
    { entry: 1, tunnel: 0, volumeMl: 0.02, pathMm: [] },
  ],
});

describe("an injection list", () => {
  it("has the passes of a tunnel together", () => {
    expect(tunnelsOf(list).map(({ entry, tunnel, passes }) => [entry, tunnel, passes.length])).toEqual([
      [0, 0, 2],
      [0, 1, 1],
      [1, 0, 1],
    ]);
    expect(tunnelsOf(list)[0].volumeMl).toBeCloseTo(0.2);
  });
  it("is a table, a pass a line, from the far end to the entry", () => {
    const lines = writeDelivery(list).trim().split("\n");
    expect(lines).toHaveLength(5);
    expect(lines[1]).toBe("1,1,deep,skin,1,0.1000,1.00,2.00,3.00,4.00,0.00,0.00");
    expect(lines[4]).toMatch(/^4,2,low,smas,1,0\.0200/);
  });
});

describe("the colours of what is missing", () => {
  it("are the same on both sides, and not stretched by single spikes", () => {
    const values = new Float32Array(2000).map((_, k) => -4 * (k / 2000));
    values[7] = 60;
    values[8] = NaN;
    const { low, high } = deficitMap(values);
    expect(high).toBe(4);
    expect(low).toBe(-4);
    expect(deficitMap(new Float32Array(100)).high).toBe(2);
  });
});
