// Arrays of meshes and frames: little-endian packed bytes, mapped without a copy where they lie on
// a boundary of their type.
import { ArrayType, type ArraySlice } from "@wire/frame_service_pb";

/** An array with all its bytes. */
export interface WireArray {
  name: string;
  unit: string;
  type: ArrayType;
  shape: number[];
  bytes: Uint8Array;
  /** UINT16 only, one of each a component */
  boxMin: number[];
  boxMax: number[];
}

export type Typed = Float32Array | Float64Array | Uint32Array | Uint16Array | Uint8Array;

/** What a page can hold of one array; more is an error, not a crash. */
const mostBytes = 1 << 30;

const sizes: Partial<Record<ArrayType, number>> = {
  [ArrayType.FLOAT32]: 4,
  [ArrayType.FLOAT64]: 8,
  [ArrayType.UINT32]: 4,
  [ArrayType.UINT16]: 2,
  [ArrayType.UINT8]: 1,
};

export function elementSize(type: ArrayType): number {
  const size = sizes[type];
  if (size === undefined) throw new Error(`an array has the unknown type ${type}`);
  return size;
}

function aligned(bytes: Uint8Array, size: number): Uint8Array {
  return bytes.byteOffset % size === 0 ? bytes : bytes.slice();
}

/**
 * The values as they came: codes for UINT16. Shares the bytes unless they lie across a boundary of
 * the type.
 */
export function view(array: WireArray): Typed {
  const size = elementSize(array.type);
  const bytes = aligned(array.bytes, size);
  const n = bytes.byteLength / size;
  switch (array.type) {
    case ArrayType.FLOAT32:
      return new Float32Array(bytes.buffer as ArrayBuffer, bytes.byteOffset, n);
    case ArrayType.FLOAT64:
      return new Float64Array(bytes.buffer as ArrayBuffer, bytes.byteOffset, n);
    case ArrayType.UINT32:
      return new Uint32Array(bytes.buffer as ArrayBuffer, bytes.byteOffset, n);
    case ArrayType.UINT16:
      return new Uint16Array(bytes.buffer as ArrayBuffer, bytes.byteOffset, n);
    default:
      return bytes;
  }
}

/** The numbers an array stands for, written into `out` where it has their length. */
export function toNumbers(array: WireArray, out?: Float32Array): Float32Array {
  const values = view(array);
  const target = out !== undefined && out.length === values.length ? out : new Float32Array(values.length);
  if (array.type !== ArrayType.UINT16) {
    target.set(values);
    return target;
  }
  const components = array.shape.length > 1 ? array.shape[array.shape.length - 1] : 1;
  if (array.boxMin.length !== components || array.boxMax.length !== components) {
    throw new Error(`${array.name} has codes without the box they are over`);
  }
  for (let c = 0; c < components; ++c) {
    const low = array.boxMin[c];
    const step = (array.boxMax[c] - low) / 65535;
    for (let k = c; k < values.length; k += components) target[k] = low + step * values[k];
  }
  return target;
}

/** Puts arrays together from their pieces. */
export class ArrayAssembler {
  private open = new Map<string, WireArray & { received: number }>();

  /** @throws Error for pieces that do not fit together */
  add(slice: ArraySlice): void {
    const shape = slice.shape.map(Number);
    const total = shape.reduce((product, n) => product * n, elementSize(slice.type));
    if (!(total <= mostBytes))
      throw new Error(`${slice.name} has ${total} bytes, more than the ${mostBytes} a page can hold`);
    const offset = Number(slice.offsetBytes);
    let array = this.open.get(slice.name);
    if (array === undefined) {
      const whole = offset === 0 && slice.data.byteLength === total;
      const { name, unit, type, boxMin, boxMax } = slice;
      array = {
        name,
        unit,
        type,
        shape,
        boxMin,
        boxMax,
        received: 0,
        bytes: whole ? slice.data : new Uint8Array(total),
      };
      this.open.set(slice.name, array);
      if (whole) {
        array.received = total;
        return;
      }
    }
    if (offset !== array.received || offset + slice.data.byteLength > array.bytes.byteLength) {
      throw new Error(`${slice.name} has a piece at byte ${offset} where ${array.received} was due`);
    }
    array.bytes.set(slice.data, offset);
    array.received += slice.data.byteLength;
  }

  /** All arrays, and an empty assembler. @throws Error for one that is not complete */
  take(): Map<string, WireArray> {
    const done = this.open;
    this.open = new Map();
    for (const array of done.values()) {
      if (array.received !== array.bytes.byteLength) throw new Error(`${array.name} is not complete`);
    }
    return done;
  }
}
