// How the skin is coloured by what a frame says of it.
import { toNumbers } from "../api/arrays";
import type { Frame } from "../api/watch";
import { mapFor, paint, quantities, skinColour, type ColourMap, type Quantity } from "./colour_maps";

/** What is coloured a vertex. */
interface Coloured {
  readonly count: number;
  readonly colours: Uint8Array;
  recolour(): void;
}

/** Numbers of a frame at the vertices of the face, in the units people read. */
export interface FaceNumbers {
  displacement: Float32Array;
  /** length of the displacement */
  moved: Float32Array;
  pressure: Float32Array;
  thickness: Float32Array;
}

/** Reads a frame into arrays that are used again for the next one. */
export class FrameReader {
  private buffers: Partial<FaceNumbers> = {};

  read(frame: Frame, mesh: string, count: number): FaceNumbers {
    const get = (field: "displacement" | "pressure" | "thickness", components: number): Float32Array => {
      const array = frame.fields.get(`${mesh}.${field}`);
      const values = array === undefined ? new Float32Array(count * components) : toNumbers(array, this.buffers[field]);
      if (values.length !== count * components)
        throw new Error(`${mesh}.${field} has ${values.length} values for ${count} vertices`);
      return (this.buffers[field] = values);
    };
    const displacement = get("displacement", 3);
    const [pressure, thickness] = [get("pressure", 1), get("thickness", 1)];
    const moved = this.buffers.moved?.length === count ? this.buffers.moved : new Float32Array(count);
    for (let k = 0; k < count; ++k) {
      moved[k] = Math.hypot(displacement[3 * k], displacement[3 * k + 1], displacement[3 * k + 2]);
      pressure[k] *= quantities.pressure.factor;
    }
    this.buffers.moved = moved;
    return { displacement, moved, pressure, thickness };
  }
}

export function largestOf(values: Float32Array): number {
  let largest = 0;
  for (const value of values) if (Math.abs(value) > largest) largest = Math.abs(value);
  return largest;
}

/** Less than this of a quantity, in its unit, fades into the skin. */
const fade: Record<Quantity, number> = { displacement: 0.15, pressure: 0.1, thickness: 0.25, distance: 0 };

/** Where there is fat at all: pressure of a dry plane is none of the patient's. */
const leastFat = 0.12;

export function valuesOf(
  quantity: Quantity,
  numbers: FaceNumbers,
  distance: Float32Array | undefined,
): Float32Array | undefined {
  return quantity === "distance" ? distance : quantity === "displacement" ? numbers.moved : numbers[quantity];
}

/** Gives a vertex the colour of the scan, or that of skin. */
function paintGround(colours: Uint8Array, at: number, own: Uint8Array | undefined): void {
  for (let c = 0; c < 3; ++c) colours[at + c] = own === undefined ? skinColour[c] : own[at + c];
}

/** Gives a surface the colours of the scan, where there are as many of them, or that of skin. */
export function colourPlain(surface: Coloured, own: Uint8Array | undefined): void {
  for (let at = 0; at < surface.colours.length; at += 3) paintGround(surface.colours, at, own);
  surface.recolour();
}

/** @param own  colours of the scan, on which those of the quantity lie */
export function colourFace(
  surface: Coloured,
  quantity: Quantity | "none",
  numbers: FaceNumbers,
  distance: Float32Array | undefined,
  map: ColourMap,
  own?: Uint8Array,
): void {
  const values = quantity === "none" ? undefined : valuesOf(quantity, numbers, distance);
  const { colours } = surface;
  for (let k = 0, at = 0; k < surface.count; ++k, at += 3) {
    const value = values === undefined ? NaN : values[k];
    const dry = quantity === "pressure" && numbers.thickness[k] < leastFat;
    const share =
      Number.isNaN(value) || dry
        ? 0
        : quantity === "distance" || fade[quantity as Quantity] === 0
          ? 1
          : Math.min(1, Math.abs(value) / fade[quantity as Quantity]);
    paintGround(colours, at, own);
    if (share === 0) continue;
    const [red, green, blue] = [colours[at], colours[at + 1], colours[at + 2]];
    paint(map, value, colours, at);
    if (share === 1) continue;
    colours[at] = red + share * (colours[at] - red);
    colours[at + 1] = green + share * (colours[at + 1] - green);
    colours[at + 2] = blue + share * (colours[at + 2] - blue);
  }
  surface.recolour();
}

/** Colours a surface by values, a vertex; as the scan is, or skin, where one is not a number. */
export function colourBy(surface: Coloured, values: Float32Array, map: ColourMap, own?: Uint8Array): void {
  for (let k = 0; k < surface.count; ++k) {
    if (Number.isNaN(values[k])) paintGround(surface.colours, 3 * k, own);
    else paint(map, values[k], surface.colours, 3 * k);
  }
  surface.recolour();
}

/**
 * A map that only grows while a run goes on, so that a colour means the same from frame to frame.
 */
export class RunningMap {
  private largest = 0;
  private of: Quantity = "displacement";
  map: ColourMap = mapFor("displacement", 1);

  /** Whether it is another one than before. */
  fit(quantity: Quantity, largest: number): boolean {
    if (quantity === this.of && largest <= this.map.high) return false;
    this.largest = quantity === this.of ? Math.max(this.largest, largest) : largest;
    const before = this.map;
    this.of = quantity;
    this.map = mapFor(quantity, this.largest);
    return before !== this.map;
  }
  forget(): void {
    this.largest = 0;
    this.map = mapFor(this.of, 1);
  }
}
