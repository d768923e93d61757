// The simulation that the page shows, and what has come of it: another one than the plan's where
// one was opened.
import { computed, signal } from "@preact/signals";
import { Simulation_State, type SeriesRow, type Simulation } from "@wire/simulation_pb";
import type { Evaluation } from "@wire/simulation_service_pb";
import type { Violation } from "../api/errors";
import type { Mesh } from "../api/meshes";
import { isLive } from "../api/runs";
import type { Frame } from "../api/watch";
import type { Axes } from "../scene/views";
import { FrameStore } from "./frame_store";

export const simulation = signal<Simulation | undefined>(undefined);
export const connection = signal<"idle" | "live" | "lost">("idle");
export const rows = signal<SeriesRow[]>([]);
export const meshes = signal<Map<string, Mesh> | undefined>(undefined);
export const frame = signal<Frame | undefined>(undefined);
/** simulated time that is looked at; undefined: the newest */
export const lookedAt = signal<number | undefined>(undefined);
/** of the frame that is shown, for figures: no faster than they can be read */
export const timeShown = signal<number | undefined>(undefined);
/**
 * Figures that change more often than this cannot be read, and drawing them takes what the face
 * needs.
 */
export const readableMs = 200;
export const skipped = signal(0);
export const store = new FrameStore();
/** "scan" or, without one, "skin" */
export const faceMesh = signal("scan");
/** the head's axes of a folder of results that is opened, where it has them */
export const runAxes = signal<Axes | undefined>(undefined);
/** how near the result is to a target, where it was compared with one */
export const distance = signal<Evaluation | undefined>(undefined);
/** what the daemon has against an injection into what runs */
export const refusals = signal<Violation[]>([]);
/** the plan that the run is of, as the page had it; empty: not known */
export const planOfRun = signal("");
/** a folder of results on this machine */
export const recorded = signal("");

export const state = computed(() => simulation.value?.state ?? Simulation_State.STATE_UNSPECIFIED);
export const isUnderWay = computed(() => isLive(state.value));
/** It takes the commands of one that runs. */
export const isRunning = computed(
  () => state.value === Simulation_State.RUNNING || state.value === Simulation_State.QUEUED,
);
export const runIsOpen = computed(() => simulation.value !== undefined || recorded.value !== "");
export const hasFrame = computed(() => frame.value !== undefined);
export const hasResult = computed(
  () => hasFrame.value && (recorded.value !== "" || (simulation.value?.summary?.steps ?? 0n) > 0n),
);
