// The picture by keyboard: arrows turn the face, or lead the tool at hand, which Enter uses.
import type { JSX } from "preact";
import { click, dab, tool } from "../plan/tools";
import { moveCamera } from "./camera";
import { addPlace } from "./rulers";
import { keyCursor, shownScene } from "./stage_state";

const turnDegrees = 6;
const nearer = 1.15;
const [cursorPixels, withShift] = [8, 1];

const directions: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** One for a stroke: from the first dab to the next move of the focus or the tool. */
let stroke = { of: tool.value };

function apply(view: HTMLElement): void {
  const at = keyCursor.value;
  if (at === undefined) return;
  const box = view.getBoundingClientRect();
  const [x, y] = [box.left + at.x, box.top + at.y];
  if (tool.value.kind === "paint") {
    if (stroke.of !== tool.value) stroke = { of: tool.value };
    const hit = shownScene.value?.hitPatch(x, y);
    if (hit) dab(hit.point, stroke);
    return;
  }
  const hit = shownScene.value?.hit(x, y);
  if (hit && tool.value.kind === "measure") addPlace(hit);
  else if (hit) click(hit.point);
}

function lead(view: HTMLElement, [dx, dy]: [number, number], by: number): void {
  const { clientWidth: width, clientHeight: height } = view;
  const from = keyCursor.value ?? { x: width / 2, y: height / 2 };
  keyCursor.value = {
    x: Math.min(width, Math.max(0, from.x + by * dx)),
    y: Math.min(height, Math.max(0, from.y + by * dy)),
  };
}

export function onStageKey(event: JSX.TargetedKeyboardEvent<HTMLDivElement>): void {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const view = event.currentTarget;
  const direction = directions[event.key];
  const hasTool = tool.value.kind !== "turn";
  if (direction && hasTool) lead(view, direction, event.shiftKey ? withShift : cursorPixels);
  else if (direction) moveCamera((of) => of.turn(-turnDegrees * direction[0], -turnDegrees * direction[1]));
  else if (event.key === "+" || event.key === "=") moveCamera((of) => of.approach(nearer));
  else if (event.key === "-") moveCamera((of) => of.approach(1 / nearer));
  else if (event.key === "Enter" && hasTool) apply(view);
  else return;
  event.preventDefault();
  event.stopPropagation();
}

/** A tool that is taken up begins in the middle of the picture. */
export function onStageFocus(event: JSX.TargetedFocusEvent<HTMLDivElement>): void {
  if (tool.value.kind !== "turn") lead(event.currentTarget, [0, 0], 0);
}
