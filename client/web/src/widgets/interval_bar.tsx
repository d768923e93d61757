// An interval as a band on a scale that begins at 0, with its middle. Words beside it say the same.
import type { Interval } from "../forecast/numbers";

export function IntervalBar({ interval: { low, middle, high }, most }: { interval: Interval; most: number }) {
  const share = (value: number): string => `${(100 * Math.min(1, Math.max(0, value / most))).toFixed(1)}%`;
  return (
    <span class="interval" aria-hidden="true">
      <i class="interval-band" style={{ left: share(low), width: share(Math.max(0, high - Math.max(0, low))) }} />
      <i class="interval-middle" style={{ left: share(middle) }} />
    </span>
  );
}
