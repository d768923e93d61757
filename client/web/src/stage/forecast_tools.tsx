// The forecast on the picture: which map, which month, and what it says under the cursor.
import { signal } from "@preact/signals";
import { mapLabels, monthWords, type ForecastView } from "../forecast/numbers";
import { forecast, forecastIsOld, forecastTime, forecastView, shownForecast, timeIndex } from "../forecast/state";
import { Segmented } from "../widgets/fields";
import { ColourBar } from "./scalar_bar";
import { step } from "./stage_state";

/** mm under the cursor, and where that is in the picture */
export const forecastProbe = signal<{ mean: number; low: number; high: number; x: number; y: number } | undefined>(
  undefined,
);

export function ForecastTools() {
  if (step.value !== "run" || !forecast.value || forecastIsOld.value) return null;
  return (
    <Segmented<ForecastView>
      label="Forecast"
      value={forecastView.value}
      onChange={(value) => (forecastView.value = value)}
      options={[
        { value: "off", label: "Result" },
        { value: "mean", label: "Expected" },
        { value: "low", label: "At least" },
        { value: "high", label: "At most" },
        { value: "spread", label: "Spread" },
      ]}
    />
  );
}

export function ForecastBar() {
  const shown = shownForecast.value;
  return shown ? <ColourBar map={shown.map} label={mapLabels[shown.view]} unit="mm" /> : null;
}

export function ForecastProbe() {
  const now = forecastProbe.value;
  if (!now || !shownForecast.value) return null;
  return (
    <div class="probe" style={{ left: `${now.x + 14}px`, top: `${now.y + 14}px` }}>
      <b>{now.mean.toFixed(1)} mm</b> expected
      <br />
      {now.low.toFixed(1)} to {now.high.toFixed(1)} mm in 90 of 100
    </div>
  );
}

/** The months that the forecast tells of take the place of the simulated time. */
export function MonthLine() {
  const times = forecast.value?.times ?? [];
  const now = forecastTime.value;
  return (
    <div class="timeline">
      <span class="months">
        <input
          type="range"
          min={0}
          max={times.length - 1}
          step={1}
          value={times.indexOf(now)}
          aria-label="Months after the injection"
          aria-valuetext={monthWords(now.month)}
          onInput={(event) => (timeIndex.value = Number(event.currentTarget.value))}
        />
        <span class="month-marks" aria-hidden="true">
          {times.map(({ month }) => (
            <span key={month}>{month === 0 ? "at once" : month}</span>
          ))}
        </span>
      </span>
      <output class="month">{monthWords(now.month)}</output>
      <button type="button" class="button small" onClick={() => (forecastView.value = "off")}>
        Result
      </button>
    </div>
  );
}
