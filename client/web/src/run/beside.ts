// Another run of the same face, beside the one on the page.
import { computed, effect, signal } from "@preact/signals";
import { Simulation_State, type Simulation } from "@wire/simulation_pb";
import { tell } from "../activity";
import { lastFrame, type LastFrame } from "../api/last_frame";
import { ownerOf } from "../api/runs";
import { runsOf } from "../case/open";
import { faceMesh, simulation } from "./state";

export interface Beside extends LastFrame {
  name: string;
  title: string;
  mesh: string;
}

/** undefined: the face before */
export const beside = signal<Beside | undefined>(undefined);
export const othersOfFace = signal<Simulation[]>([]);

const over = [Simulation_State.SETTLED, Simulation_State.FINISHED, Simulation_State.STOPPED];
const ownModel = computed(() => simulation.value?.spec?.model ?? "");

export const titleOf = ({ displayName, name, summary }: Simulation): string =>
  `${displayName || name.split("/")[1]}, ${(summary?.injectedMl ?? 0).toFixed(1)} mL`;

/** Runs that are over, of any plan of this patient. */
export async function listOthers(): Promise<void> {
  const owner = ownerOf(ownModel.value);
  if (owner === "") return;
  try {
    const all = await runsOf(owner);
    if (ownerOf(ownModel.value) !== owner) return;
    othersOfFace.value = all.filter(({ name, state }) => name !== simulation.value?.name && over.includes(state));
  } catch (error) {
    tell(error);
  }
}

export async function putBeside(name: string): Promise<void> {
  const other = othersOfFace.value.find((one) => one.name === name);
  if (other === undefined) return void (beside.value = undefined);
  const mesh = faceMesh.value;
  try {
    const fields = ["displacement", "pressure", "thickness"].map((field) => `${mesh}.${field}`);
    const found = await lastFrame(name, fields);
    beside.value = { ...found, name, mesh, title: titleOf(other) };
  } catch (error) {
    tell(error);
  }
}

/** What is of another patient is never beside this one. */
export function bindBeside(): () => void {
  let before = "";
  return effect(() => {
    const owner = ownerOf(ownModel.value);
    if (owner !== before) [beside.value, othersOfFace.value] = [undefined, []];
    before = owner;
  });
}
