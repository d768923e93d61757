// Keeps the forecast in the scene as the page has it.
import { computed, effect } from "@preact/signals";
import { valuesOf } from "../forecast/numbers";
import { forecastTime, shownForecast } from "../forecast/state";
import type { FaceScene } from "../scene/face_scene";
import { ForecastSurface } from "../scene/forecast_surface";

let surface: ForecastSurface | undefined;

const perVertex = computed(() => {
  const time = forecastTime.value;
  return time && [valuesOf(time, "mean"), valuesOf(time, "low"), valuesOf(time, "high")];
});

export function bindForecast(scene: FaceScene): () => void {
  const of = new ForecastSurface(scene.viewport);
  surface = of;
  const end = effect(() => of.show(shownForecast.value));
  return () => {
    end();
    of.dispose();
    surface = undefined;
  };
}

/** Reads the forecast under a place on the screen [mm]. */
export function forecastAt(clientX: number, clientY: number): { mean: number; low: number; high: number } | undefined {
  if (!shownForecast.value || !perVertex.value) return undefined;
  const found = surface?.valuesAt(clientX, clientY, perVertex.value);
  return found && { mean: found[0], low: found[1], high: found[2] };
}
