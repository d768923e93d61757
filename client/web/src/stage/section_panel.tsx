// The section as a drawing to scale, with the fat between the layers.
import { readable } from "../plan/anatomy";
import { cssOf } from "../scene/colour_maps";
import { layerColours } from "../scene/layers";
import type { Section } from "../scene/section";
import { Segmented } from "../widgets/fields";
import { layerNames, noTissue, row, section, showSection } from "./section_state";

const fatColour = "#f7e96b";
const margin = 3;
const barMm = 10;

function Drawing({ cut }: { cut: Section }) {
  const height = cut.high - cut.low;
  const path = (outline: [number, number][]): string =>
    `M${outline.map(([x, y]) => `${x.toFixed(2)} ${(cut.high - y).toFixed(2)}`).join("L")}Z`;
  const fat = cut.fat.map(({ layer, thickest }) => `${thickest.toFixed(1)} mm below ${layerNames.value[layer]}`);
  return (
    <svg
      viewBox={`${-margin} ${-margin} ${cut.width + 2 * margin} ${height + 2 * margin + 5}`}
      role="img"
      aria-label={`Section, ${cut.width.toFixed(0)} mm wide; fat: ${fat.join(", ") || "none in this section"}`}
    >
      {cut.layers.map((outline, k) => (
        <path key={k} d={path(outline)} fill={cssOf(layerColours[k % layerColours.length])} />
      ))}
      {cut.fat.map(({ layer, outline }) => (
        <path key={layer} class="section-fat" d={path(outline)} fill={fatColour} />
      ))}
      <g class="section-scale">
        <line x1={0} x2={barMm} y1={height + 3.2} y2={height + 3.2} />
        <text x={barMm + 1.5} y={height + 4.4}>
          {barMm} mm
        </text>
      </g>
    </svg>
  );
}

function Legend({ cut }: { cut: Section }) {
  return (
    <ul class="section-legend">
      {layerNames.value.map((name, k) => (
        <li key={name}>
          <i class="swatch" style={{ background: cssOf(layerColours[k % layerColours.length]) }} aria-hidden="true" />
          {readable(name)}
        </li>
      ))}
      {cut.fat.map(({ layer, thickest, area }) => (
        <li key={`fat-${layer}`} data-fat={thickest.toFixed(2)}>
          <i class="swatch" style={{ background: fatColour }} aria-hidden="true" />
          <span>
            Fat below {readable(layerNames.value[layer] ?? "").toLowerCase()}: <b>{thickest.toFixed(1)} mm</b> at most,{" "}
            {area.toFixed(0)} mm²
          </span>
        </li>
      ))}
      {cut.fat.length === 0 && <li class="quiet">No fat in this section</li>}
    </ul>
  );
}

export function SectionPanel() {
  if (!showSection.value) return null;
  const cut = section.value;
  return (
    <section class="section-panel" aria-label="Section through the layers">
      <header class="row">
        <h3>Section</h3>
        <Segmented
          label="Section goes"
          value={row.value.across}
          options={[
            { value: "xi", label: "Along" },
            { value: "eta", label: "Across" },
          ]}
          onChange={(across) => (row.value = { ...row.value, across })}
        />
        <input
          type="range"
          class="grow"
          min={0}
          max={1}
          step={0.01}
          value={row.value.share}
          aria-label="Place of the section"
          onInput={(event) => (row.value = { ...row.value, share: Number(event.currentTarget.value) })}
        />
        <button type="button" class="icon" aria-label="Close the section" onClick={() => (showSection.value = false)}>
          ×
        </button>
      </header>
      {cut ? (
        <>
          <Drawing cut={cut} />
          <Legend cut={cut} />
        </>
      ) : (
        <p class="quiet" role="status">
          {noTissue.value ? "This run has no tissue to cut." : "Cutting…"}
        </p>
      )}
    </section>
  );
}
