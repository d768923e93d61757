// The section that is looked at: tissue and fat of a run as they are now.
import { computed, effect, signal } from "@preact/signals";
import { tell } from "../activity";
import { toNumbers } from "../api/arrays";
import type { Coordinates } from "../api/meshes";
import { lastFrame } from "../api/last_frame";
import { chart, model } from "../plan/state";
import { isUnderWay, simulation } from "../run/state";
import { cutSection, type Row, type Section } from "../scene/section";

interface Tissue {
  of: string;
  cells: Uint32Array;
  rest: Coordinates;
  points: Coordinates;
}

export const showSection = signal(false);
/** a row by its share of the way through the model */
export const row = signal<{ across: Row["across"]; share: number }>({ across: "xi", share: 0.5 });
const tissue = signal<Tissue | undefined>(undefined);
/** There is no tissue to cut: a plan of a plate under rigid walls. */
export const noTissue = signal(false);

/** The page knows the rows of the tissue by the model of the run. */
export const canCut = computed(
  () =>
    simulation.value !== undefined && simulation.value.spec?.model === model.value?.name && chart.value !== undefined,
);

const versionOf = computed(
  () => `${simulation.value?.name ?? ""} ${isUnderWay.value} ${simulation.value?.summary?.steps ?? 0}`,
);

const gridOf = computed(() => {
  const layers = model.value?.spec?.layers ?? [];
  if (!chart.value || layers.length === 0) return undefined;
  return {
    nXi: chart.value.nXi,
    nEta: chart.value.nEta,
    elementsThrough: layers.map(({ elementsThrough }) => elementsThrough ?? 1),
  };
});

export const layerNames = computed(() => (model.value?.spec?.layers ?? []).map(({ name }) => name));

export const section = computed<Section | undefined>(() => {
  const [now, grid] = [tissue.value, gridOf.value];
  if (!showSection.value || !canCut.value || !now || !grid) return undefined;
  if (now.of !== simulation.value?.name) return undefined;
  const levels = grid.elementsThrough.reduce((sum, n) => sum + n, 0);
  if (now.cells.length !== 8 * levels * grid.nXi * grid.nEta) return undefined;
  const { across, share } = row.value;
  const index = Math.round(share * (across === "xi" ? grid.nEta : grid.nXi));
  const last = layerNames.value[layerNames.value.length - 1];
  const below = (simulation.value.spec?.films ?? []).some(({ belowLayer }) => belowLayer === last);
  return cutSection(now.cells, now.points, now.rest, grid, { across, index }, below);
});

async function load(of: string, left: AbortSignal): Promise<void> {
  const { meshes, frame } = await lastFrame(of, ["tissue.displacement"], left);
  const [mesh, field] = [meshes.get("tissue"), frame.fields.get("tissue.displacement")];
  if (left.aborted) return;
  noTissue.value = !mesh || !field;
  if (!mesh || !field) return;
  const moved = toNumbers(field);
  const points = mesh.points.map((value, k) => value + moved[k]);
  tissue.value = { of, cells: mesh.cells, rest: mesh.points, points };
}

/** While it is looked at, the section follows the run: one look after the other. */
export function bindSection(): () => void {
  let [leave, busy, again] = [new AbortController(), false, false];
  const look = async (): Promise<void> => {
    const name = simulation.peek()?.name;
    if (name === undefined) return;
    if (busy) return void (again = true);
    busy = true;
    try {
      await load(name, leave.signal);
    } catch (error) {
      if (!leave.signal.aborted) tell(error);
    }
    busy = false;
    if (again && !leave.signal.aborted) {
      again = false;
      void look();
    }
  };
  const end = effect(() => {
    void versionOf.value;
    if (showSection.value && canCut.value) void look();
  });
  return () => {
    end();
    leave.abort();
    leave = new AbortController();
  };
}
