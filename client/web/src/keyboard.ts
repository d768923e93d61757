// Keys: 1 to 5 the steps, Ctrl+Z back, space run or pause, arrows through time, Esc out of a tool.
import { signal } from "@preact/signals";
import { lookAt, runOrPause } from "./run/run";
import { frame, hasResult, store } from "./run/state";
import { brushMm, tool } from "./plan/tools";
import { redo, undo } from "./plan/state";
import { compare, presenting, quantity, step, stepNames } from "./stage/stage_state";

const keptAs = "lipofill.single-keys";

function kept(): boolean {
  try {
    return localStorage.getItem(keptAs) !== "off";
  } catch {
    return true; // a browser that keeps nothing
  }
}

/** Letters, digits and brackets do something by themselves. */
export const singleKeys = signal(kept());

export function keepSingleKeys(wanted: boolean): void {
  singleKeys.value = wanted;
  try {
    localStorage.setItem(keptAs, wanted ? "on" : "off");
  } catch {
    // It holds until the page is left.
  }
}

function stepThroughTime(by: number): void {
  const all = store.frames;
  const at = frame.value === undefined ? -1 : all.indexOf(frame.value);
  const next = all[Math.min(all.length - 1, Math.max(0, at + by))];
  if (next) lookAt(next.timeS);
}

/** Ctrl+Z, Ctrl+Shift+Z, Ctrl+Y. What is being typed has its own. */
function changeBack(event: KeyboardEvent, target: HTMLElement): void {
  const key = event.key.toLowerCase();
  if (event.altKey || target.closest("[data-typing], dialog")) return;
  if (key === "y" || (key === "z" && event.shiftKey)) redoChange();
  else if (key === "z") undoChange();
  else return;
  event.preventDefault();
}

/** A tool may be at something that is no longer there. */
export function undoChange(): void {
  tool.value = { kind: "turn" };
  undo();
}
export function redoChange(): void {
  tool.value = { kind: "turn" };
  redo();
}

export function onKey(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.metaKey) return changeBack(event, target);
  if (event.altKey) return;
  if (event.key === "Escape" && tool.value.kind === "turn") presenting.value = false;
  if (event.key === "Escape") tool.value = { kind: "turn" };
  if (target.closest("input:not([type=range], [type=checkbox], [type=radio], [type=file]), select, dialog")) return;
  const itsOwn =
    event.key === " "
      ? "button, a, input"
      : event.key.startsWith("Arrow") || event.key === "End"
        ? "input[type=range], input[type=radio]"
        : "";
  if (itsOwn && target.closest(itsOwn)) return;
  if (event.key === " ") void runOrPause();
  else if (event.key === "ArrowLeft" && hasResult.value) stepThroughTime(-1);
  else if (event.key === "ArrowRight" && hasResult.value) stepThroughTime(1);
  else if (event.key === "End") lookAt(undefined);
  else if (!singleKeys.value) return;
  else if (/^[1-5]$/.test(event.key)) step.value = stepNames[Number(event.key) - 1];
  else if (event.key === "[") brushMm.value = Math.max(1, brushMm.value - 1);
  else if (event.key === "]") brushMm.value = Math.min(40, brushMm.value + 1);
  else if (event.key === "c" && hasResult.value)
    compare.value = compare.value === "after" ? "side" : compare.value === "side" ? "slider" : "after";
  else if (event.key === "d") quantity.value = "displacement";
  else if (event.key === "p") quantity.value = "pressure";
  else if (event.key === "t") quantity.value = "thickness";
  else return;
  event.preventDefault();
}
