// Step 5: run it, steer it, take the result home.
import { signal } from "@preact/signals";
import { create } from "@bufbuild/protobuf";
import { ScanUnit } from "@wire/plan_pb";
import { InjectionSchema, Simulation_State } from "@wire/simulation_pb";
import { simulations } from "../api/client";
import { uploadScan } from "../api/upload";
import { readable } from "../plan/anatomy";
import { plainWords } from "../plan/field_words";
import { canRun, plan, scanFile } from "../plan/state";
import { attempt, busy } from "../activity";
import { liveSite, tool } from "../plan/tools";
import { stateClass, stateWord } from "../run/exports";
import { close, command, inject, planHasChanged, run } from "../run/run";
import { distance, hasResult, isRunning, isUnderWay, recorded, simulation, state } from "../run/state";
import { FileButton, NumberField, Section, SelectField } from "../widgets/fields";
import { quantity } from "../stage/stage_state";
import { AddedFat } from "./added_fat";
import { ForecastSection } from "./forecast_section";
import { ReportSection } from "./report_section";
import { Exports, Recorded } from "./take_home";

const more = signal({ zone: "", volumeMl: 0.5 as number | undefined, rateMlPerS: 1 as number | undefined });

function Controls() {
  const now = state.value;
  const ready = !isUnderWay.value;
  return (
    <Section
      title="Simulation"
      aside={
        <span class={`state ${stateClass(simulation.value)}`}>
          {recorded.value ? "Recorded" : stateWord(simulation.value)}
        </span>
      }
    >
      <div class="row">
        {ready && (
          <button
            type="button"
            class="button primary grow"
            disabled={busy.value !== undefined || !canRun.value}
            onClick={() => void run()}
          >
            ▶ Run
          </button>
        )}
        {now === Simulation_State.READY && (
          <button type="button" class="button primary grow" onClick={() => void command("startSimulation")}>
            ▶ Start
          </button>
        )}
        {isRunning.value && (
          <button type="button" class="button primary grow" onClick={() => void command("pauseSimulation")}>
            ❚❚ Pause
          </button>
        )}
        {now === Simulation_State.PAUSED && (
          <button type="button" class="button primary grow" onClick={() => void command("resumeSimulation")}>
            ▶ Resume
          </button>
        )}
        {(isRunning.value || now === Simulation_State.PAUSED) && (
          <button type="button" class="button" onClick={() => void command("stopSimulation")}>
            ■ Stop
          </button>
        )}
        {(now !== Simulation_State.STATE_UNSPECIFIED || recorded.value) && ready && (
          <button type="button" class="button" onClick={close}>
            Close
          </button>
        )}
      </div>
      {planHasChanged.value && (
        <p class="warning">The plan has changed since this run: its results are of the plan before.</p>
      )}
      {simulation.value?.reason && (
        <p class={now === Simulation_State.FAILED ? "complaint" : "quiet"}>
          {plainWords(simulation.value.reason, plan.value)}
        </p>
      )}
      {simulation.value?.summary?.preview && (
        <p class="quiet">
          Preview: {["", "waiting", "running", "done", "failed", "outdated"][simulation.value.summary.preview.state]}
          {simulation.value.summary.preview.differenceMaxMm !== undefined &&
            `, ${simulation.value.summary.preview.differenceMaxMm.toFixed(2)} mm off at most`}
        </p>
      )}
    </Section>
  );
}

function InjectMore() {
  const names = (simulation.value?.spec?.films ?? []).flatMap((film) => film.zones.map(({ name }) => name));
  const zone = names.includes(more.value.zone) ? more.value.zone : (names[0] ?? "");
  const placing = tool.value.kind === "live_site";
  return (
    <Section title="Inject more">
      <SelectField
        label="Into"
        value={zone}
        options={names.map((name) => ({ value: name, label: readable(name) }))}
        field="injection.zone"
        onChange={(value) => (more.value = { ...more.value, zone: value })}
      />
      <div class="pair">
        <NumberField
          label="Volume"
          unit="mL"
          step={0.1}
          value={more.value.volumeMl}
          field="injection.volume_ml"
          onChange={(volumeMl) => (more.value = { ...more.value, volumeMl })}
        />
        <NumberField
          label="Rate"
          unit="mL/s"
          step={0.1}
          value={more.value.rateMlPerS}
          field="injection.rate_ml_per_s"
          onChange={(rateMlPerS) => (more.value = { ...more.value, rateMlPerS })}
        />
      </div>
      <div class="row">
        <button
          type="button"
          class="button small"
          aria-pressed={placing}
          onClick={() => (tool.value = placing ? { kind: "turn" } : { kind: "live_site" })}
        >
          {liveSite.value ? "Move the point" : "Place the point"}
        </button>
        <button
          type="button"
          class="button"
          onClick={() => void inject(create(InjectionSchema, { ...more.value, zone, site: liveSite.value }))}
        >
          Inject
        </button>
      </div>
    </Section>
  );
}

async function compareWith(file: File): Promise<void> {
  await attempt("Measuring the distance to the goal", async (progress) => {
    const { name, spec } = simulation.value!;
    const parent = spec!.model.split("/models/")[0];
    const target = await uploadScan(
      parent,
      file.name,
      await file.arrayBuffer(),
      scanFile.value.unit ?? ScanUnit.MILLIMETRE,
      (share) => progress(share / 2),
    );
    progress(0.6);
    distance.value = await simulations.evaluateSimulation({ name, targetScan: target.name });
    quantity.value = "distance";
  });
}

function Target() {
  const result = distance.value?.simulatedToTarget;
  const before = distance.value?.beforeToTarget;
  return (
    <Section title="Goal">
      <FileButton label="Compare with a scan…" accept=".obj,.ply,.stl" onFiles={([file]) => void compareWith(file)} />
      {result && before && (
        <table class="figures-table">
          <thead>
            <tr>
              <td />
              <th scope="col">before</th>
              <th scope="col">simulated</th>
            </tr>
          </thead>
          <tbody>
            <tr>
              <th scope="row">Mean</th>
              <td>{before.meanMm.toFixed(2)}</td>
              <td>{result.meanMm.toFixed(2)} mm</td>
            </tr>
            <tr>
              <th scope="row">RMS</th>
              <td>{before.rmsMm.toFixed(2)}</td>
              <td>{result.rmsMm.toFixed(2)} mm</td>
            </tr>
            <tr>
              <th scope="row">95 of 100 within</th>
              <td>{before.p95Mm.toFixed(2)}</td>
              <td>{result.p95Mm.toFixed(2)} mm</td>
            </tr>
          </tbody>
        </table>
      )}
    </Section>
  );
}

export function RunPanel() {
  return (
    <>
      <Controls />
      {isUnderWay.value && <InjectMore />}
      {state.value === Simulation_State.SETTLED && !recorded.value && <AddedFat />}
      {hasResult.value && !recorded.value && <Target />}
      {!recorded.value && <ForecastSection />}
      {!recorded.value && <ReportSection />}
      <Exports />
      <Recorded />
    </>
  );
}
