// Which steps are done: what they are for is there, whoever has looked at them.
import { computed } from "@preact/signals";
import { Simulation_State } from "@wire/simulation_pb";
import { region, modelIsCurrent, plan, scan, violations } from "./plan/state";
import { planHasChanged } from "./run/run";
import { hasResult, recorded, runIsOpen, state } from "./run/state";

/** Of three points a face has a place in space. */
const fewestLandmarks = 3;

const isPlate = computed(() => plan.value.model?.geometry.case === "square");

export const isEmpty = computed(() => scan.value === undefined && !isPlate.value && !runIsOpen.value);

export const faceIsDone = computed(
  () =>
    isPlate.value ||
    (scan.value !== undefined && Object.keys(region.value?.landmarksMm ?? {}).length >= fewestLandmarks),
);

/** Fat goes into every zone that has to be filled, and the daemon has nothing against it. */
export const fatIsDone = computed(() => {
  const { films = [], injections = [] } = plan.value.simulation ?? {};
  const names = films.flatMap(({ zones }) => zones.map(({ name }) => name));
  const filled = injections.filter(({ zone, volumeMl }) => names.includes(zone) && (volumeMl ?? 0) !== 0);
  const refused = violations.value.some(({ field }) => field.startsWith("simulation"));
  return modelIsCurrent.value && filled.length > 0 && !refused;
});

const over = [Simulation_State.SETTLED, Simulation_State.FINISHED, Simulation_State.STOPPED];
export const runIsDone = computed(
  () => hasResult.value && (recorded.value !== "" || over.includes(state.value)) && !planHasChanged.value,
);
