// A card of the dashboard says whose a simulation is, how far it has come and what is wrong.
import { Simulation_State, type Simulation } from "@wire/simulation_pb";
import { isLive as isLiveState, ownerOf as ownerOfName } from "../api/runs";
import { mmHgPerPa, pressureBands } from "../scene/colour_maps";

/** A simulation between looks. */
export interface Seen {
  steps: bigint;
  timeS: number;
  /** of the last look, and of the last at which it had gone on [ms] */
  atMs: number;
  movedMs: number;
  /** since the look before */
  stepsPerS: number;
  /** simulated seconds a second of the clock, smoothed; 0: not known */
  pace: number;
}

export interface Card {
  simulation: Simulation;
  seen: Seen;
}

/** So many simulations that have ended are shown, the newest. */
const mostEnded = 24;
/** A run that takes no step for so long is stalled; a shape found directly is one long step. */
const [stalledMs, stalledDirectlyMs] = [15_000, 300_000];
const defaultEndS = 60;
const paceKept = 0.7;

/** Running first; what ended, last. */
const order: Simulation_State[] = [
  Simulation_State.RUNNING,
  Simulation_State.PAUSED,
  Simulation_State.QUEUED,
  Simulation_State.READY,
  Simulation_State.FAILED,
  Simulation_State.SETTLED,
  Simulation_State.FINISHED,
  Simulation_State.STOPPED,
];
const rank = ({ state }: Simulation): number => order.indexOf(state);
const age = ({ createTime }: Simulation): number => -Number(createTime?.seconds ?? 0n);
export const isLive = ({ state }: Simulation): boolean => isLiveState(state);

export function choose(all: Simulation[]): Simulation[] {
  const ended = all
    .filter((one) => !isLive(one))
    .sort((a, b) => rank(a) - rank(b) || age(a) - age(b))
    .slice(0, mostEnded);
  return [...all.filter(isLive), ...ended].sort((a, b) => rank(a) - rank(b) || age(a) - age(b));
}

/** Adds to the last look what this one tells. */
export function see({ state, summary }: Simulation, before: Seen | undefined, nowMs: number): Seen {
  const [steps, timeS] = [summary?.steps ?? 0n, summary?.timeS ?? 0];
  const at = { steps, timeS, atMs: nowMs };
  if (before === undefined || state !== Simulation_State.RUNNING)
    return { ...at, movedMs: nowMs, stepsPerS: 0, pace: 0 };
  const elapsed = Math.max(1e-3, (nowMs - before.atMs) / 1000);
  const now = (timeS - before.timeS) / elapsed;
  return {
    ...at,
    movedMs: steps === before.steps ? before.movedMs : nowMs,
    stepsPerS: Number(steps - before.steps) / elapsed,
    pace: before.pace === 0 ? now : paceKept * before.pace + (1 - paceKept) * now,
  };
}

const endOf = ({ spec }: Simulation): number => spec?.time?.endS ?? defaultEndS;

/** Share of the time that it runs at most: it may settle before. */
export const progressOf = (simulation: Simulation): number =>
  Math.min(1, (simulation.summary?.timeS ?? 0) / Math.max(1e-9, endOf(simulation)));

/** "at most 3 min left"; empty where it is not known. */
export function timeLeft({ simulation, seen }: Card): string {
  if (simulation.state !== Simulation_State.RUNNING || seen.pace <= 0) return "";
  const seconds = (endOf(simulation) - seen.timeS) / seen.pace;
  if (seconds < 90) return `at most ${Math.max(1, Math.ceil(seconds))} s left`;
  if (seconds < 90 * 60) return `at most ${Math.ceil(seconds / 60)} min left`;
  return `at most ${Math.ceil(seconds / 3600)} h left`;
}

export const pressureOf = ({ summary }: Simulation): number => (summary?.maxPressurePa ?? 0) * mmHgPerPa;

/** Lists what somebody has to look at. */
export function alarmsOf({ simulation, seen }: Card): string[] {
  const alarms: string[] = [];
  const { state, reason, summary, recovery } = simulation;
  if (state === Simulation_State.FAILED) alarms.push(`failed: ${reason || "the daemon does not say why"}`);
  const patience = summary?.way === "directly" ? stalledDirectlyMs : stalledMs;
  if (state === Simulation_State.RUNNING && seen.atMs - seen.movedMs > patience && recovery === undefined)
    alarms.push(`stalled: no step for ${((seen.atMs - seen.movedMs) / 1000).toFixed(0)} s`);
  if (isLive(simulation) && recovery?.waitingFor) alarms.push(`not back yet: ${recovery.waitingFor}`);
  const high = pressureBands.at(-1)!.from;
  if (isLive(simulation) && pressureOf(simulation) >= high)
    alarms.push(`pressure ${pressureOf(simulation).toFixed(0)} mmHg, above ${high}`);
  return alarms;
}

/** patients/{patient}; empty where it is not known */
export const ownerOf = ({ spec }: Simulation): string => ownerOfName(spec?.model ?? "");
