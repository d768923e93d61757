// The colours of what is missing: a scale that single spikes do not stretch.
import { mapFor, type ColourMap } from "./colour_maps";

/** So little is within what a scan is off by: the scale does not magnify it. */
const leastScaleMm = 2;
/** Beyond this share of the skin the colours no longer change. */
const share = 0.999;

/** @param distances  signed [mm], NaN where the skin is not compared */
export function deficitMap(distances: Float32Array): ColourMap {
  const sizes = distances
    .filter((value) => !Number.isNaN(value))
    .map(Math.abs)
    .sort();
  const high = sizes[Math.min(sizes.length - 1, Math.floor(share * sizes.length))] ?? 0;
  return mapFor("distance", Math.max(leastScaleMm, high));
}
