// Back and forth through the frames that came.
import { lookAt } from "../run/run";
import { connection, frame, hasResult, lookedAt, rows, skipped, store, timeShown } from "../run/state";
import { showsForecast } from "../forecast/state";
import { MonthLine } from "./forecast_tools";
import { rate } from "./stage_state";

export function Timeline() {
  if (showsForecast.value) return <MonthLine />;
  if (timeShown.value === undefined) return null;
  const end = Math.max(store.latest?.timeS ?? 0, rows.value.at(-1)?.timeS ?? 0);
  const now = timeShown.value;
  const following = lookedAt.value === undefined;
  return (
    <div class="timeline">
      <input
        type="range"
        min={0}
        max={end}
        step={0.01}
        value={now}
        aria-label="Simulated time"
        aria-valuetext={`${now.toFixed(2)} seconds`}
        disabled={!hasResult.value}
        onInput={(event) => lookAt(Number(event.currentTarget.value))}
      />
      <output>{now.toFixed(2)} s</output>
      <button type="button" class="button small" aria-pressed={following} onClick={() => lookAt(undefined)}>
        Newest
      </button>
      {frame.peek()?.preview && <span class="tag-inline">Preview</span>}
      <span class="quiet rate" title={`${skipped.peek()} frames were left out`}>
        {connection.value === "live"
          ? `${rate.value.toFixed(0)} pictures/s`
          : `${store.frames.length} ${store.frames.length === 1 ? "frame" : "frames"}`}
      </span>
    </div>
  );
}
