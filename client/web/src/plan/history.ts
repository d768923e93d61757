// What was changed, to be taken back and done again.
import { signal } from "@preact/signals";

/** So many changes can be taken back. */
const most = 100;

export class History<T> {
  private readonly past = signal<readonly T[]>([]);
  private readonly future = signal<readonly T[]>([]);
  private stroke: unknown;

  get canUndo(): boolean {
    return this.past.value.length > 0;
  }
  get canRedo(): boolean {
    return this.future.value.length > 0;
  }

  /**
   * Remembers what a change replaces.
   * @param stroke  changes with the same one, which follow each other, are taken back together
   */
  add(before: T, stroke?: unknown): void {
    const goesOn = stroke !== undefined && stroke === this.stroke;
    this.stroke = stroke;
    if (goesOn) return;
    this.past.value = [...this.past.value, before].slice(-most);
    this.future.value = [];
  }

  /** What was there before the last change; undefined where there is none. */
  undo(now: T): T | undefined {
    const before = this.past.value.at(-1);
    if (before === undefined) return undefined;
    this.stroke = undefined;
    this.past.value = this.past.value.slice(0, -1);
    this.future.value = [...this.future.value, now];
    return before;
  }

  /** What was there before the last change was taken back. */
  redo(now: T): T | undefined {
    const after = this.future.value.at(-1);
    if (after === undefined) return undefined;
    this.stroke = undefined;
    this.future.value = this.future.value.slice(0, -1);
    this.past.value = [...this.past.value, now];
    return after;
  }

  forget(): void {
    this.stroke = undefined;
    [this.past.value, this.future.value] = [[], []];
  }
}
