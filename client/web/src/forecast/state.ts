// The forecast of the plan: what is known of its result, how well, and what months leave of it.
import { computed, signal } from "@preact/signals";
import { Retention_Preset, type Forecast } from "@wire/forecast_service_pb";
import { model, modelMeshes } from "../plan/state";
import { step } from "../stage/stage_state";
import { planText } from "../target/state";
import { mapOf, valuesOf, type ForecastView } from "./numbers";

export interface Asked {
  /** cases of tissue that are solved */
  members: number;
  retention: Retention_Preset;
}

export const asked = signal<Asked>({ members: 500, retention: Retention_Preset.POOLED });

/** with the model and the plan that it is of */
export const made = signal<{ found: Forecast; model: string; planText: string } | undefined>(undefined);
/** It is of the model that is open: a case, a scan or a model that is left takes it along. */
export const forecast = computed(() => (made.value?.model === model.value?.name ? made.value?.found : undefined));
export const forecastIsOld = computed(() => forecast.value !== undefined && made.value!.planText !== planText.value);

/** place among the times of the forecast */
export const timeIndex = signal(0);
export const forecastView = signal<ForecastView>("off");

export const forecastTime = computed(() => {
  const times = forecast.value?.times ?? [];
  return times[Math.min(timeIndex.value, times.length - 1)];
});

/** Figures and timeline are those of the forecast; of another plan they are not shown. */
export const showsForecast = computed(
  () =>
    step.value === "run" && forecastView.value !== "off" && forecastTime.value !== undefined && !forecastIsOld.value,
);

const colours = computed(() =>
  forecast.value && forecastView.value !== "off" ? mapOf(forecast.value, forecastView.value) : undefined,
);

/** The picture shows the skin of the model as it moves on average, in the colours of the map. */
export const shownForecast = computed(() => {
  const [time, view, skin] = [forecastTime.value, forecastView.value, modelMeshes.value?.get("skin")];
  if (!showsForecast.value || time === undefined || view === "off" || skin === undefined) return undefined;
  if (time.meanDisplacementMm.length !== skin.points.length) return undefined;
  return {
    skin,
    displacement: Float32Array.from(time.meanDisplacementMm),
    values: valuesOf(time, view),
    map: colours.value!,
    time,
    view,
  };
});
