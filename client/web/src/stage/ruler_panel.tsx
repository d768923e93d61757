// Rulers: what to measure with, and what was measured.
import { tool, type Ruler } from "../plan/tools";
import { measures, placesOf, readings, removeMeasure, unitOf } from "./rulers";
import { showRulers } from "./stage_state";

const names: Record<Ruler, string> = { distance: "Distance", skin: "Along the skin", angle: "Angle" };
const rulers = Object.keys(names) as Ruler[];
const least = 0.05;

export function RulerPanel() {
  if (!showRulers.value) return null;
  const now = tool.value.kind === "measure" ? tool.value.ruler : undefined;
  return (
    <section class="ruler-panel" aria-label="Rulers">
      <div class="row wrap">
        {rulers.map((ruler) => (
          <button
            type="button"
            key={ruler}
            class="button small"
            aria-pressed={now === ruler}
            title={`Click ${placesOf[ruler]} places on the face`}
            onClick={() => (tool.value = now === ruler ? { kind: "turn" } : { kind: "measure", ruler })}
          >
            {names[ruler]}
          </button>
        ))}
      </div>
      {measures.value.length > 0 && (
        <ul class="items">
          {readings.value.map(({ ruler, value, before }, k) => (
            <li key={k} class="item" data-ruler={ruler}>
              <span class="grow">
                {names[ruler]}{" "}
                <b>{value === undefined ? "no way along the skin" : `${value.toFixed(1)}${unitOf(ruler)}`}</b>
                {value !== undefined && before !== undefined && Math.abs(value - before) >= least && (
                  <span class="quiet">
                    {" "}
                    before {before.toFixed(1)}
                    {unitOf(ruler)}
                  </span>
                )}
              </span>
              <button
                type="button"
                class="icon"
                aria-label={`Remove ${names[ruler].toLowerCase()} ${k + 1}`}
                onClick={() => removeMeasure(k)}
              >
                ×
              </button>
            </li>
          ))}
        </ul>
      )}
    </section>
  );
}
