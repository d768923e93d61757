// What runs say of themselves in every part of the page: whose they are, and whether they go on.
import { Simulation_State } from "@wire/simulation_pb";

const live = [Simulation_State.READY, Simulation_State.QUEUED, Simulation_State.RUNNING, Simulation_State.PAUSED];

/** A run that has not ended. */
export const isLive = (state: Simulation_State): boolean => live.includes(state);

/** The patient that a scan, a model or a plan belongs to: patients/{patient}; empty for no name. */
export const ownerOf = (name: string): string => name.split("/").slice(0, 2).join("/");
