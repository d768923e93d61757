// The figures a surgeon looks for first, and how they came about.
import { plainWords } from "../plan/field_words";
import { plan } from "../plan/state";
import { lookAt } from "../run/run";
import { rows, simulation, timeShown } from "../run/state";
import { bandOf, cssOf, mmHgPerPa, pressureBands } from "../scene/colour_maps";
import { Plot } from "../widgets/plot";
import { showsForecast } from "../forecast/state";
import { ForecastFigures } from "./forecast_figures";
import { ZoneTable } from "./zone_table";

function Figure({
  label,
  value,
  unit,
  note,
  chip,
}: {
  label: string;
  value: string;
  unit: string;
  note?: string;
  chip?: string;
}) {
  return (
    <div class="figure">
      <span class="figure-label">{label}</span>
      <span class="figure-value" data-figure={label}>
        {value}
        <small>{unit}</small>
      </span>
      {note && (
        <span class="figure-note">
          {chip && <i class="swatch" style={{ background: chip }} aria-hidden="true" />}
          {note}
        </span>
      )}
    </div>
  );
}

/** The row at the time that is looked at. */
function rowNow() {
  const at = timeShown.value;
  const all = rows.value;
  if (at === undefined || all.length === 0) return all.at(-1);
  let [low, high] = [0, all.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (all[middle].timeS <= at + 1e-9) low = middle;
    else high = middle - 1;
  }
  return all[low];
}

/** What was to be taken out, and was not there. */
function NotTakenOut() {
  const owed = -(simulation.value?.summary?.undeliveredMl ?? 0);
  if (owed < 0.005) return null;
  return <p class="warning">{owed.toFixed(2)} mL could not be taken out: there is no more fat to take.</p>;
}

function Zones() {
  const zones = simulation.value?.summary?.zones ?? [];
  if (zones.length === 0) return null;
  return <ZoneTable zones={zones} />;
}

/** What to know before relying on the figures. */
function Remarks() {
  const remarks = simulation.value?.summary?.remarks ?? [];
  if (remarks.length === 0) return null;
  return (
    <section class="remarks" aria-label="Remarks">
      <h3>Remarks</h3>
      <ul>
        {remarks.map((remark) => (
          <li key={remark}>{plainWords(remark, plan.value)}</li>
        ))}
      </ul>
    </section>
  );
}

export function Figures() {
  return showsForecast.value ? <ForecastFigures /> : <RunFigures />;
}

function RunFigures() {
  const row = rowNow();
  const all = rows.value;
  const times = all.map(({ timeS }) => timeS);
  const pressure = (row?.maxPressurePa ?? 0) * mmHgPerPa;
  const band = bandOf(pressure);
  const pick = (timeS: number): void => lookAt(timeS);
  return (
    <aside class="figures" aria-label="Figures" tabIndex={0}>
      <Figure label="Injected" value={(row?.injectedMl ?? 0).toFixed(2)} unit="mL" />
      <Figure
        label="Highest pressure"
        value={pressure.toFixed(1)}
        unit="mmHg"
        note={`${((row?.maxPressurePa ?? 0) / 1000).toFixed(2)} kPa · ${pressureBands[band].name} mmHg`}
        chip={cssOf(pressureBands[band].colour)}
      />
      <Figure label="Skin rises" value={(row?.skinMaxDisplacementMm ?? 0).toFixed(1)} unit="mm" />
      <Figure label="Simulated time" value={(timeShown.value ?? row?.timeS ?? 0).toFixed(1)} unit="s" />
      <NotTakenOut />
      <Zones />
      <Remarks />
      {all.length > 1 && (
        <>
          <Plot
            title="Volume"
            unit="mL"
            times={times}
            now={timeShown.value}
            onPick={pick}
            lines={[{ name: "injected", colour: "#0b6e6e", values: all.map(({ injectedMl }) => injectedMl) }]}
          />
          <Plot
            title="Highest pressure"
            unit="mmHg"
            times={times}
            now={timeShown.value}
            onPick={pick}
            lines={[
              {
                name: "pressure",
                colour: "#a8321f",
                values: all.map(({ maxPressurePa }) => maxPressurePa * mmHgPerPa),
              },
            ]}
          />
          <Plot
            title="Skin rises"
            unit="mm"
            times={times}
            now={timeShown.value}
            onPick={pick}
            lines={[
              {
                name: "skin",
                colour: "#34507a",
                values: all.map(({ skinMaxDisplacementMm }) => skinMaxDisplacementMm),
              },
            ]}
          />
        </>
      )}
    </aside>
  );
}
