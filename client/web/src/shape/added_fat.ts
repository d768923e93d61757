// Fat that a run which has settled may have more of, or less: its shape first, then the injection.
import { create } from "@bufbuild/protobuf";
import { computed, signal } from "@preact/signals";
import { InjectionSchema } from "@wire/simulation_pb";
import { busy } from "../activity";
import { newId } from "../api/client";
import type { ShapeRequest } from "../api/find_shape";
import { inject } from "../run/run";
import { faceMesh, simulation } from "../run/state";
import { beginDrag, findFinal, findWhileDragged, forgetShape } from "./finder";

export const wanted = signal({ zone: "", volumeMl: 0, rateMlPerS: 1 as number | undefined });

export const zoneNames = computed(() =>
  (simulation.value?.spec?.films ?? []).flatMap((film) => film.zones.map(({ name }) => name)),
);
/** The one that is chosen, else the first. */
export const zone = computed(() => {
  const names = zoneNames.value;
  return names.includes(wanted.value.zone) ? wanted.value.zone : (names[0] ?? "");
});

/** What is in the zone now [mL]: no more can be taken out. */
export const inZone = computed(
  () => simulation.value?.summary?.zones.find(({ name }) => name === zone.value)?.volumeMl ?? 0,
);

/** One name for all shapes of a run. */
let drag = { of: "", name: "" };

function request(): ShapeRequest {
  const { name } = simulation.value!;
  if (drag.of !== name) drag = { of: name, name: newId() };
  return {
    plan: { case: "simulation", value: name },
    added: [{ zone: zone.value, volumeMl: wanted.value.volumeMl }],
    drag: drag.name,
  };
}

export function dragAdded(volumeMl: number): void {
  wanted.value = { ...wanted.value, volumeMl };
  beginDrag("run");
  findWhileDragged(faceMesh.value, request());
}

/** Shows what the volume would do; without one the run is shown as it is. */
export function releaseAdded(volumeMl: number): void {
  wanted.value = { ...wanted.value, volumeMl };
  if (volumeMl === 0) return forgetShape();
  beginDrag("run");
  findFinal(faceMesh.value, request());
}

export function chooseZone(name: string): void {
  wanted.value = { ...wanted.value, zone: name, volumeMl: 0 };
  forgetShape();
}

/** The run goes on with the injection until it has settled again. */
export async function addToRun(): Promise<void> {
  const { volumeMl, rateMlPerS } = wanted.value;
  busy.value = { label: "Going back to where the run came to rest", share: undefined };
  const taken = await inject(create(InjectionSchema, { zone: zone.value, volumeMl, rateMlPerS }));
  busy.value = undefined;
  if (!taken) return;
  forgetShape();
  wanted.value = { ...wanted.value, volumeMl: 0 };
}
