// From numbers to colours that the colour-blind tell apart, and back to words for the scalar bar.
export type Rgb = [number, number, number];

export interface ColourMap {
  /** 256 colours, from the low end to the high one */
  table: Uint8Array;
  low: number;
  high: number;
}

// From what hardly differs from skin to a blue that no skin has; lightness falls all along.
const tide: Rgb[] = [
  [238, 236, 222],
  [196, 224, 208],
  [128, 196, 202],
  [66, 150, 192],
  [36, 98, 164],
  [24, 44, 106],
];
const fire: Rgb[] = [
  [238, 232, 222],
  [250, 205, 134],
  [240, 150, 80],
  [205, 92, 78],
  [148, 50, 92],
  [84, 26, 84],
];
const diverging: Rgb[] = [
  [33, 82, 158],
  [104, 158, 206],
  [198, 220, 235],
  [246, 244, 240],
  [250, 214, 176],
  [224, 132, 74],
  [158, 54, 32],
];

export const mmHgPerPa = 1 / 133.322;

/**
 * The bands of settled pressure. Their bounds are assumed, see "Pressure bands" of the reference;
 * lightness falls from band to band.
 */
export const pressureBands: { from: number; name: string; colour: Rgb }[] = [
  { from: -Infinity, name: "below 9", colour: [112, 196, 178] },
  { from: 9, name: "9 to 15", colour: [240, 200, 80] },
  { from: 15, name: "15 to 30", colour: [222, 122, 40] },
  { from: 30, name: "above 30", colour: [158, 26, 44] },
];

export function bandOf(mmHg: number): number {
  let band = 0;
  for (let k = 1; k < pressureBands.length; ++k) if (mmHg >= pressureBands[k].from) band = k;
  return band;
}

function interpolate(stops: Rgb[]): Uint8Array {
  const table = new Uint8Array(256 * 3);
  for (let k = 0; k < 256; ++k) {
    const x = (k / 255) * (stops.length - 1);
    const i = Math.min(Math.floor(x), stops.length - 2);
    for (let c = 0; c < 3; ++c) table[3 * k + c] = Math.round(stops[i][c] + (x - i) * (stops[i + 1][c] - stops[i][c]));
  }
  return table;
}

function banded(high: number): Uint8Array {
  const table = new Uint8Array(256 * 3);
  for (let k = 0; k < 256; ++k) table.set(pressureBands[bandOf((k / 255) * high)].colour, 3 * k);
  return table;
}

export type Quantity = "displacement" | "pressure" | "thickness" | "distance";

export interface QuantityInfo {
  label: string;
  unit: string;
  /** from the unit on the wire */
  factor: number;
}

export const quantities: Record<Quantity, QuantityInfo> = {
  displacement: { label: "Skin displacement", unit: "mm", factor: 1 },
  pressure: { label: "Fat pressure", unit: "mmHg", factor: mmHgPerPa },
  thickness: { label: "Fat thickness", unit: "mm", factor: 1 },
  distance: { label: "Distance to the goal", unit: "mm", factor: 1 },
};

/** A round number at or above. */
export function roundUp(value: number): number {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  for (const step of [1, 1.5, 2, 3, 4, 5, 6, 8, 10]) if (value <= step * power * (1 + 1e-9)) return step * power;
  return 10 * power;
}

/** @param largest  magnitude that must be on the map */
export function mapFor(quantity: Quantity, largest: number): ColourMap {
  const high = roundUp(largest);
  switch (quantity) {
    case "pressure":
      return { table: banded(Math.max(40, high)), low: 0, high: Math.max(40, high) };
    case "distance":
      return { table: interpolate(diverging), low: -high, high };
    case "thickness":
      return { table: interpolate(fire), low: 0, high };
    default:
      return { table: interpolate(tide), low: 0, high };
  }
}

/** Writes three bytes of colour for `value`. */
export function paint(map: ColourMap, value: number, out: Uint8Array, at: number): void {
  const share = (value - map.low) / (map.high - map.low);
  const k = 3 * Math.min(255, Math.max(0, Math.round(share * 255)));
  out[at] = map.table[k];
  out[at + 1] = map.table[k + 1];
  out[at + 2] = map.table[k + 2];
}

export function cssOf(colour: ArrayLike<number>): string {
  return `rgb(${colour[0]} ${colour[1]} ${colour[2]})`;
}

export const skinColour: Rgb = [226, 196, 176];
/** Of zones, told apart also without red or green. */
export const zoneColours: Rgb[] = [
  [0, 114, 178],
  [230, 159, 0],
  [0, 158, 115],
  [204, 121, 167],
  [86, 180, 233],
  [213, 94, 0],
  [120, 94, 160],
];

/** Of entries of the cannula and their tunnels, on zones of any colour. */
export const entryColours: Rgb[] = [
  [150, 20, 60],
  [20, 60, 150],
  [90, 40, 0],
  [0, 80, 60],
  [90, 30, 120],
  [40, 40, 40],
];
