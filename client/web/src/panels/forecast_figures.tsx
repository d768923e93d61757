// Figures of the forecast at the month that is looked at, each with the band that 90 of 100 cases
// lie in.
import type { ForecastTime } from "@wire/forecast_service_pb";
import { figureOf, intervalOf, monthWords, mostOf, shareWords } from "../forecast/numbers";
import { forecast, forecastTime } from "../forecast/state";
import { readable } from "../plan/anatomy";
import { cssOf, pressureBands } from "../scene/colour_maps";
import { IntervalBar } from "../widgets/interval_bar";

interface OfFigure {
  time: ForecastTime;
  name: string;
  zone?: string;
  label: string;
  unit: string;
  decimals?: number;
}

function Figure({ time, name, zone = "", label, unit, decimals = 1 }: OfFigure) {
  const figure = figureOf(time, name, zone);
  if (!figure) return null;
  const interval = intervalOf(figure);
  const words = (value: number): string => value.toFixed(decimals);
  return (
    <div class="figure">
      <span class="figure-label">{label}</span>
      <span class={zone === "" ? "figure-value" : "figure-value smaller"} data-forecast={`${name} ${zone}`.trim()}>
        {words(interval.middle)}
        <small>{unit}</small>
      </span>
      <IntervalBar interval={interval} most={mostOf(forecast.value!, name, zone)} />
      <span class="figure-note" data-interval={`${name} ${zone}`.trim()}>
        {words(interval.low)} to {words(interval.high)} {unit}
      </span>
    </div>
  );
}

function Bands({ time, zone }: { time: ForecastTime; zone: string }) {
  const bands = time.bands.find((one) => one.zone === zone);
  if (!bands) return null;
  const shares = [bands.below9Mmhg, bands.from9To15Mmhg, bands.from15To30Mmhg, bands.above30Mmhg];
  return (
    <ul class="band-shares" aria-label={`How often its pressure is in each band, ${readable(zone)}`}>
      {shares.map((share, k) =>
        share > 0 ? (
          <li key={k}>
            <i class="swatch" style={{ background: cssOf(pressureBands[k].colour) }} aria-hidden="true" />
            {pressureBands[k].name} mmHg: {shareWords(share)}
          </li>
        ) : null,
      )}
    </ul>
  );
}

export function ForecastFigures() {
  const time = forecastTime.value;
  const zones = [...new Set(time.figures.map(({ zone }) => zone).filter((zone) => zone !== ""))];
  return (
    <aside class="figures" aria-label="Figures of the forecast" tabIndex={0}>
      <h3 role="status">Forecast, {monthWords(time.month)}</h3>
      <p class="quiet">The middle of {time.members} cases of tissue; 90 of 100 lie in the band below each figure.</p>
      <Figure time={time} name="max_lift" label="Skin rises" unit="mm" />
      <Figure time={time} name="skin_volume" label="Volume that the face gains" unit="mL" decimals={2} />
      {zones.map((zone) => (
        <section key={zone} class="forecast-zone" aria-label={readable(zone)}>
          <h3>{readable(zone)}</h3>
          <div class="pair">
            <Figure time={time} name="volume" zone={zone} label="Fat" unit="mL" decimals={2} />
            <Figure time={time} name="mean_pressure" zone={zone} label="Pressure" unit="mmHg" />
          </div>
          <Bands time={time} zone={zone} />
        </section>
      ))}
    </aside>
  );
}
