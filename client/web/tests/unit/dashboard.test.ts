// What the dashboard makes of simulations: their order, how far they have come, what is wrong.
import { create } from "@bufbuild/protobuf";
import { Simulation_State, SimulationSchema, type Simulation } from "@wire/simulation_pb";
import { describe, expect, it } from "vitest";
import { alarmsOf, choose, ownerOf, progressOf, see, timeLeft } from "../../src/dashboard/cards";

type More = Parameters<typeof create<typeof SimulationSchema>>[1];
const simulation = (name: string, state: Simulation_State, more: More = {}): Simulation =>
  create(SimulationSchema, { name, state, ...more });
const running = (timeS: number, steps: bigint, more: object = {}): Simulation =>
  simulation("s", Simulation_State.RUNNING, { summary: { timeS, steps, ...more }, spec: { time: { endS: 100 } } });

describe("the order of cards", () => {
  it("has what runs first, the newest of each first, and what ended last", () => {
    const at = (seconds: number): More => ({ createTime: { seconds: BigInt(seconds) } });
    const all = [
      simulation("stopped", Simulation_State.STOPPED, at(9)),
      simulation("old", Simulation_State.RUNNING, at(1)),
      simulation("failed", Simulation_State.FAILED, at(2)),
      simulation("new", Simulation_State.RUNNING, at(3)),
      simulation("paused", Simulation_State.PAUSED, at(4)),
      simulation("settled", Simulation_State.SETTLED, at(5)),
    ];
    expect(choose(all).map(({ name }) => name)).toEqual(["new", "old", "paused", "failed", "settled", "stopped"]);
  });

  it("keeps what is alive however many there are, and 24 of those that ended", () => {
    const all = [
      ...Array.from({ length: 40 }, (_, k) => simulation(`r${k}`, Simulation_State.RUNNING)),
      ...Array.from({ length: 40 }, (_, k) => simulation(`e${k}`, Simulation_State.FINISHED)),
    ];
    expect(choose(all)).toHaveLength(64);
  });
});

describe("progress", () => {
  it("is the share of the longest time that it takes, and what is left by its pace", () => {
    const first = see(running(10, 100n), undefined, 1000);
    const second = see(running(12, 120n), first, 2000);
    expect(second).toMatchObject({ stepsPerS: 20, pace: 2 });
    expect(progressOf(running(12, 120n))).toBeCloseTo(0.12);
    expect(timeLeft({ simulation: running(12, 120n), seen: second })).toBe("at most 44 s left");
    expect(timeLeft({ simulation: running(12, 120n), seen: { ...second, pace: 0.5 } })).toBe("at most 3 min left");
    expect(timeLeft({ simulation: running(12, 120n), seen: { ...second, pace: 0.01 } })).toBe("at most 3 h left");
    expect(timeLeft({ simulation: running(10, 100n), seen: first }), "not known after one look").toBe("");
  });
});

describe("an alarm", () => {
  const alarms = (of: Simulation, before = see(of, undefined, 0), nowMs = 1000): string[] =>
    alarmsOf({ simulation: of, seen: see(of, before, nowMs) });

  it("is a pressure above the last band, as long as it lives", () => {
    expect(alarms(running(1, 1n, { maxPressurePa: 29.9 * 133.322 }))).toEqual([]);
    expect(alarms(running(1, 1n, { maxPressurePa: 31 * 133.322 }))).toEqual(["pressure 31 mmHg, above 30"]);
    const settled = simulation("s", Simulation_State.SETTLED, { summary: { maxPressurePa: 9000 } });
    expect(alarms(settled)).toEqual([]);
  });

  it("is a run that makes no step, later for one long step, and not for one that waits", () => {
    const still = running(1, 5n);
    expect(alarms(still, see(still, undefined, 0), 15_000)).toEqual([]);
    expect(alarms(still, see(still, undefined, 0), 16_000)).toEqual(["stalled: no step for 16 s"]);
    const directly = running(0, 0n, { way: "directly" });
    expect(alarms(directly, see(directly, undefined, 0), 16_000)).toEqual([]);
    const queued = simulation("s", Simulation_State.QUEUED);
    expect(alarms(queued, see(queued, undefined, 0), 900_000)).toEqual([]);
  });

  it("is a failure, with its reason", () => {
    expect(alarms(simulation("s", Simulation_State.FAILED, { reason: "the film ran dry" }))).toEqual([
      "failed: the film ran dry",
    ]);
  });
});

describe("whose it is", () => {
  it("is in the name of its model", () => {
    const of = (model: string) => ownerOf(simulation("s", Simulation_State.READY, { spec: { model } }));
    expect(of("patients/p1/models/m1")).toBe("patients/p1");
    expect(of("")).toBe("");
  });
});
