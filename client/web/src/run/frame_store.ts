// The frames of a run, to scrub through: bounded in bytes, over the whole of its time.
//
// When it is full every second frame goes and from then on only every second that comes stays, and
// so on: a long run is held coarser, never cut. The newest frame is always there.
import type { Frame } from "../api/watch";

export class FrameStore {
  private held: Frame[] = [];
  private newest: Frame | undefined;
  private bytes = 0;
  private stride = 1;
  /** frames that came, held or not */
  arrived = 0;

  constructor(private readonly mostBytes = 96 << 20) {}

  add(frame: Frame): void {
    this.newest = frame;
    if (this.arrived++ % this.stride === 0) {
      this.held.push(frame);
      this.bytes += sizeOf(frame);
    }
    while (this.bytes > this.mostBytes && this.held.length > 2) this.thin();
  }

  /** A frame of an earlier moment than those that came; the newest stays what it is. */
  insert(frame: Frame): void {
    this.held = [...this.held.filter(({ sequence }) => sequence !== frame.sequence), frame];
    this.held.sort((a, b) => a.timeS - b.timeS);
    this.bytes = this.held.reduce((sum, one) => sum + sizeOf(one), 0);
    this.newest ??= frame;
  }

  /** Frames of another epoch show steps that the daemon takes again. */
  dropAfter(sequence: bigint): void {
    this.held = this.held.filter((frame) => frame.sequence <= sequence);
    this.bytes = this.held.reduce((sum, frame) => sum + sizeOf(frame), 0);
    this.newest = this.held.at(-1);
  }

  clear(): void {
    Object.assign(this, { held: [], newest: undefined, bytes: 0, stride: 1, arrived: 0 });
  }

  private thin(): void {
    this.held = this.held.filter((_, index) => index % 2 === 0);
    this.stride *= 2;
    this.bytes = this.held.reduce((sum, frame) => sum + sizeOf(frame), 0);
  }

  get sizeBytes(): number {
    return this.bytes;
  }
  /** In the order they came, the newest last. */
  get frames(): Frame[] {
    const last = this.held.at(-1);
    return this.newest === undefined || last === this.newest ? this.held : [...this.held, this.newest];
  }
  get latest(): Frame | undefined {
    return this.newest;
  }
  /** The one at or before a simulated time, else the first. */
  at(timeS: number): Frame | undefined {
    const all = this.frames;
    let [low, high] = [0, all.length - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (all[middle].timeS <= timeS + 1e-9) low = middle;
      else high = middle - 1;
    }
    return all[low];
  }
}

/** Also of the buffer behind the arrays: a message's arrays share one. */
function sizeOf(frame: Frame): number {
  const buffers = new Set<ArrayBufferLike>();
  for (const field of frame.fields.values()) buffers.add(field.bytes.buffer);
  return [...buffers].reduce((sum, buffer) => sum + buffer.byteLength, 0);
}
