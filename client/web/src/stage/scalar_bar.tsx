// What the colours mean.
import type { ComponentChildren } from "preact";
import { cssOf, pressureBands, quantities, type ColourMap, type Quantity } from "../scene/colour_maps";

function gradient({ table }: ColourMap): string {
  const stops = Array.from({ length: 33 }, (_, k) => {
    const at = Math.min(255, k * 8);
    return `${cssOf(table.subarray(3 * at, 3 * at + 3))} ${((k / 32) * 100).toFixed(1)}%`;
  });
  return `linear-gradient(to top, ${stops.join(",")})`;
}

function Bands({ map }: { map: ColourMap }) {
  return (
    <div class="bar bands">
      {pressureBands.map(({ colour, from, name }, k) => {
        const low = Math.max(0, from);
        const high = Math.min(map.high, pressureBands[k + 1]?.from ?? map.high);
        return (
          <div key={name} style={{ background: cssOf(colour), flexGrow: high - low }}>
            <span>{name}</span>
          </div>
        );
      })}
    </div>
  );
}

function Shades({ map }: { map: ColourMap }) {
  const marks = [0, 0.25, 0.5, 0.75, 1].map((share) => map.low + share * (map.high - map.low));
  return (
    <div class="bar" style={{ background: gradient(map) }}>
      {marks.map((mark, k) => (
        <span key={k} style={{ bottom: `${k * 25}%` }}>
          {Number(mark.toPrecision(3))}
        </span>
      ))}
    </div>
  );
}

interface Meaning {
  map: ColourMap;
  label: string;
  unit: string;
}

function Titled({ map, label, unit, children }: Meaning & { children: ComponentChildren }) {
  return (
    <div class="scalar-bar" role="img" aria-label={`${label}, from ${map.low} to ${map.high} ${unit}`}>
      <div class="scalar-title">
        {label}
        <br />
        <span class="quiet">{unit}</span>
      </div>
      {children}
    </div>
  );
}

/** Numbers of one kind, without words for the ends. */
export function ColourBar(meaning: Meaning) {
  return (
    <Titled {...meaning}>
      <Shades map={meaning.map} />
    </Titled>
  );
}

export function ScalarBar({ map, quantity }: { map: ColourMap; quantity: Quantity }) {
  const { label, unit } = quantities[quantity];
  return (
    <Titled map={map} label={label} unit={unit}>
      {quantity === "distance" && <div class="bar-end">too much</div>}
      {quantity === "pressure" ? <Bands map={map} /> : <Shades map={map} />}
      {quantity === "distance" && <div class="bar-end below">missing</div>}
    </Titled>
  );
}
