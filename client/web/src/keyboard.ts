// Keys: 1 to 4 the steps, space run or pause, arrows through time, Esc out of a tool.
import { lookAt, runOrPause } from "./run/run";
import { frame, hasResult, store } from "./run/state";
import { brushMm, tool } from "./plan/tools";
import { compare, quantity, step, type Step } from "./stage/stage_state";

const steps: Step[] = ["face", "tissue", "fat", "run"];

function stepThroughTime(by: number): void {
  const all = store.frames;
  const at = frame.value === undefined ? -1 : all.indexOf(frame.value);
  const next = all[Math.min(all.length - 1, Math.max(0, at + by))];
  if (next) lookAt(next.timeS);
}

export function onKey(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "Escape") tool.value = { kind: "turn" };
  if (target.closest("input[type=number], input[type=text], input[type=password], select, dialog")) return;
  const itsOwn =
    event.key === " "
      ? "button, a, input"
      : event.key.startsWith("Arrow") || event.key === "End"
        ? "input[type=range]"
        : "";
  if (itsOwn && target.closest(itsOwn)) return;
  if (/^[1-4]$/.test(event.key)) step.value = steps[Number(event.key) - 1];
  else if (event.key === " ") void runOrPause();
  else if (event.key === "ArrowLeft" && hasResult.value) stepThroughTime(-1);
  else if (event.key === "ArrowRight" && hasResult.value) stepThroughTime(1);
  else if (event.key === "End") lookAt(undefined);
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
