// The figures of a shape that was not run, on the picture.
import { ZoneTable } from "../panels/zone_table";
import { plainWords } from "../plan/field_words";
import { plan } from "../plan/state";
import { run } from "../run/run";
import { simulation } from "../run/state";
import { bandOf, cssOf, mmHgPerPa, pressureBands } from "../scene/colour_maps";
import { figures, isFinal, refusal, shownShapeOf, type ShapeOf } from "../shape/state";
import { showsForecast } from "../forecast/state";
import { step } from "./stage_state";
import type { FoundShape } from "@wire/simulation_service_pb";

/** A figure, and beside it the one of the run before fat is added. */
function Figure({ label, value, unit, before, chip, note }: FigureProps) {
  return (
    <div>
      <dt>{label}</dt>
      <dd data-shape-figure={label}>
        {value}
        <small>{unit}</small>
        {before !== undefined && <span class="figure-note">now {before}</span>}
        {note && (
          <span class="figure-note">
            <i class="swatch" style={{ background: chip }} aria-hidden="true" />
            {note}
          </span>
        )}
      </dd>
    </div>
  );
}

interface FigureProps {
  label: string;
  value: string;
  unit: string;
  before?: string;
  chip?: string;
  note?: string;
}

function Numbers({ found, of }: { found: FoundShape; of: ShapeOf }) {
  const summary = found.summary!;
  const before = of === "run" ? simulation.value?.summary : undefined;
  const pressure = summary.maxPressurePa * mmHgPerPa;
  const band = pressureBands[bandOf(pressure)];
  return (
    <>
      <dl>
        <Figure
          label="Skin rises"
          unit="mm"
          value={summary.skinMaxDisplacementMm.toFixed(1)}
          before={before?.skinMaxDisplacementMm.toFixed(1)}
        />
        <Figure
          label="Highest pressure"
          unit="mmHg"
          value={pressure.toFixed(1)}
          before={before && (before.maxPressurePa * mmHgPerPa).toFixed(1)}
          chip={cssOf(band.colour)}
          note={`${band.name} mmHg`}
        />
        <Figure label="Volume" unit="mL" value={summary.injectedMl.toFixed(2)} before={before?.injectedMl.toFixed(2)} />
      </dl>
      {summary.zones.length > 1 && <ZoneTable zones={summary.zones} />}
      {found.volumeShare < 1 && (
        <p class="warning">
          Only {(100 * found.volumeShare).toFixed(0)} % of the fat goes in, and that is what is shown: {found.reason}
        </p>
      )}
    </>
  );
}

/** Those of the run stand beside its own figures. */
function Remarks({ found, of }: { found: FoundShape; of: ShapeOf }) {
  const known = of === "run" ? (simulation.value?.summary?.remarks ?? []) : [];
  const remarks = (found.summary?.remarks ?? []).filter((remark) => !known.includes(remark));
  if (remarks.length === 0) return null;
  return (
    <section class="remarks" aria-label="Remarks on the shape">
      <ul>
        {remarks.map((remark) => (
          <li key={remark}>{plainWords(remark, plan.value)}</li>
        ))}
      </ul>
    </section>
  );
}

const titles: Record<ShapeOf, string> = {
  plan: "Settled shape, not yet run",
  run: "Settled shape with this change, not yet injected",
};

export function ShapeReadout() {
  const of = shownShapeOf.value;
  const found = figures.value;
  if (showsForecast.value) return null; // its figures are of another time
  if (of === undefined || (found === undefined && refusal.value === "")) return null;
  return (
    <section class="shape-readout" aria-label="Shape of these volumes" tabIndex={0}>
      <h3 role="status">
        {refusal.value !== "" ? "No shape to show" : isFinal.value ? titles[of] : "Finding the settled shape…"}
      </h3>
      {refusal.value !== "" && <p class="warning">{plainWords(refusal.value, plan.value)}</p>}
      {found && <Numbers found={found} of={of} />}
      {found && isFinal.value && <Remarks found={found} of={of} />}
      {of === "plan" && (isFinal.value || refusal.value !== "") && (
        <button
          type="button"
          class="button small"
          onClick={() => {
            step.value = "run";
            void run();
          }}
        >
          Run this plan
        </button>
      )}
    </section>
  );
}
