// What is taken home from a run, and runs that are opened again.
import { signal } from "@preact/signals";
import type { Simulation } from "@wire/simulation_pb";
import { simulations } from "../api/client";
import { writePlan } from "../plan/plan_file";
import { canRun, fileOfScan, plan, scanFile } from "../plan/state";
import { attempt, tell } from "../activity";
import { save, stateWord, surfaceObj } from "../run/exports";
import { openRun } from "../case/open";
import { hasResult, rows, simulation } from "../run/state";
import { writeSeries } from "../run/series_csv";
import { FileButton, Section, SelectField } from "../widgets/fields";
import { shownShapeOf } from "../shape/state";
import { shownScene } from "../stage/stage_state";

export function Exports() {
  const name = plan.value.name || "plan";
  const savePicture = async (): Promise<void> => {
    try {
      if (shownScene.value) save(`${name}.png`, await shownScene.value.viewport.capture());
    } catch (error) {
      tell(error);
    }
  };
  const saveMesh = (): void => {
    const scene = shownScene.value;
    if (scene?.points && scene.mesh)
      save(`${name}.obj`, surfaceObj(scene.points, scene.mesh.cells, scene.mesh.corners));
  };
  return (
    <Section title="Take home">
      <div class="row wrap">
        <button
          type="button"
          class="button"
          disabled={!canRun.value}
          onClick={() => save(`${name}.json`, writePlan(plan.value, fileOfScan.value, scanFile.value.unit))}
        >
          Plan
        </button>
        <button
          type="button"
          class="button"
          disabled={rows.value.length === 0}
          onClick={() => save(`${name}.csv`, writeSeries(rows.value, simulation.value?.spec?.probes ?? []))}
        >
          CSV
        </button>
        <button type="button" class="button" onClick={() => void savePicture()}>
          Picture
        </button>
        <button
          type="button"
          class="button"
          disabled={!hasResult.value || shownShapeOf.value !== undefined}
          onClick={saveMesh}
        >
          Mesh
        </button>
      </div>
      <p class="quiet">
        The plan runs with <code>lipofill run</code> beside {fileOfScan.value}.
      </p>
    </Section>
  );
}

const known = signal<Simulation[]>([]);

export function Recorded() {
  const load = async (): Promise<void> => {
    try {
      known.value = (await simulations.listSimulations({ pageSize: 1000 })).simulations;
    } catch (error) {
      tell(error);
    }
  };
  return (
    <Section title="Open a run">
      <div class="field" onFocusCapture={() => void load()} onPointerEnter={() => void load()}>
        <SelectField
          label="Of the daemon"
          value={known.value.some(({ name }) => name === simulation.value?.name) ? simulation.value!.name : ""}
          onChange={(value) => {
            const next = known.value.find(({ name }) => name === value);
            if (next) void openRun(next.name);
          }}
          options={[
            { value: "", label: "Choose…" },
            ...known.value.map((one) => ({
              value: one.name,
              label: `${one.displayName || one.name.split("/")[1]} · ${stateWord(one)} · ${(one.summary?.injectedMl ?? 0).toFixed(1)} mL`,
            })),
          ]}
        />
      </div>
      <FileButton
        label="Result folder…"
        folder
        onFiles={(files) =>
          void attempt("Reading the results", async (progress) => {
            const { openFolder } = await import("../run/recorded"); // and with it the toolkit's reader
            await openFolder(files, progress);
          })
        }
      />
    </Section>
  );
}
