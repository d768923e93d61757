// The page shows a forecast by these: maps of the skin, and figures with their intervals.
import type { Forecast, ForecastFigure, ForecastTime } from "@wire/forecast_service_pb";
import { mapFor, mmHgPerPa, type ColourMap } from "../scene/colour_maps";

/** The skin is coloured by it; "off": the run, or the face, is shown in its place. */
export type ForecastView = "off" | "mean" | "low" | "high" | "spread";
export type ForecastMap = Exclude<ForecastView, "off">;

export const mapLabels: Record<ForecastMap, string> = {
  mean: "Skin rises, expected",
  low: "Skin rises at least, in 95 of 100 cases",
  high: "Skin rises at most, in 95 of 100 cases",
  spread: "From 5 to 95 of 100 cases",
};

/** mm a vertex of the model's skin */
export function valuesOf({ meanDisplacementMm, liftP05Mm, liftP95Mm }: ForecastTime, view: ForecastMap): Float32Array {
  switch (view) {
    case "low":
      return Float32Array.from(liftP05Mm);
    case "high":
      return Float32Array.from(liftP95Mm);
    case "spread":
      return Float32Array.from(liftP95Mm, (high, k) => high - liftP05Mm[k]);
    default:
      return Float32Array.from({ length: Math.floor(meanDisplacementMm.length / 3) }, (_, k) =>
        Math.hypot(...meanDisplacementMm.slice(3 * k, 3 * k + 3)),
      );
  }
}

const largest = (values: Iterable<number>): number => {
  let most = 0;
  for (const value of values) if (value > most) most = value;
  return most;
};

/** One scale for every month: a colour means the same in all of them. */
export function mapOf({ times }: Forecast, view: ForecastMap): ColourMap {
  if (view === "spread")
    return mapFor("thickness", Math.max(...times.map((time) => largest(valuesOf(time, "spread")))));
  return mapFor("displacement", Math.max(...times.map(({ liftP95Mm }) => largest(liftP95Mm))));
}

export function monthWords(month: number): string {
  if (month === 0) return "at once";
  return `after ${month} ${month === 1 ? "month" : "months"}`;
}

export interface Interval {
  /** half of the cases stay below */
  middle: number;
  low: number;
  high: number;
}

/** The interval has the unit that is shown: mmHg for pressures. */
export function intervalOf({ unit, p05, p50, p95 }: ForecastFigure): Interval {
  const factor = unit === "Pa" ? mmHgPerPa : 1;
  return { low: factor * p05, middle: factor * p50, high: factor * p95 };
}

export const figureOf = (time: ForecastTime, name: string, zone = ""): ForecastFigure | undefined =>
  time.figures.find((figure) => figure.name === name && figure.zone === zone);

/** The largest upper end of a figure over all months: ends of its bars. */
export function mostOf({ times }: Forecast, name: string, zone = ""): number {
  const ends = times.map((time) => figureOf(time, name, zone)).map((figure) => (figure ? intervalOf(figure).high : 0));
  return Math.max(1e-6, ...ends);
}

/** "87 of 100"; a share that is not nothing is not said to be nothing. */
export function shareWords(share: number): string {
  if (share > 0 && share < 0.005) return "below 1 of 100";
  if (share < 1 && share > 0.995) return "above 99 of 100";
  return `${(100 * share).toFixed(0)} of 100`;
}
