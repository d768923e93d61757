// What the cursor does over the picture: it probes, clicks places, paints; turning is the
// toolkit's.
import type { RefObject } from "preact";
import { useEffect } from "preact/hooks";
import { click, dab, tool } from "../plan/tools";
import { shownDistances, shownFrame } from "./shown";
import { goalProbe, probe, shownScene } from "./stage_state";

/** A press that moved further was a turn of the face. */
const clickPixels = 4;

export function useCursor(main: RefObject<HTMLDivElement>): void {
  useEffect(() => {
    const element = main.current!;
    const outer = element.parentElement!;
    let [downX, downY, due] = [0, 0, 0];
    /** of the brush that is down */
    let stroke: object | undefined;

    const leave = (): void => {
      cancelAnimationFrame(due);
      [probe.value, goalProbe.value] = [undefined, undefined];
    };
    const paint = (event: PointerEvent): void => {
      const hit = shownScene.value?.hitPatch(event.clientX, event.clientY);
      if (hit) dab(hit.point, stroke);
    };
    const down = (event: PointerEvent): void => {
      [downX, downY] = [event.clientX, event.clientY];
      probe.value = undefined;
      if (tool.value.kind !== "paint" || event.button !== 0 || !element.contains(event.target as Node)) return;
      if (!shownScene.value?.hitPatch(event.clientX, event.clientY)) return;
      event.stopPropagation();
      outer.setPointerCapture(event.pointerId);
      stroke = {};
      paint(event);
    };
    const move = (event: PointerEvent): void => {
      if (stroke) {
        event.stopPropagation();
        paint(event);
        return;
      }
      if (event.buttons !== 0 || (shownFrame.value === undefined && shownDistances.value === undefined)) return;
      if (!(event.target as HTMLElement).closest(".view")) return leave();
      const { clientX, clientY } = event;
      cancelAnimationFrame(due);
      due = requestAnimationFrame(() => {
        const scene = shownScene.value;
        const box = outer.getBoundingClientRect();
        const place = { x: clientX - box.left, y: clientY - box.top };
        const found = scene?.probe(clientX, clientY);
        probe.value = found && { ...found, ...place };
        const toGoalMm = shownDistances.value && scene?.distanceAt(clientX, clientY);
        goalProbe.value = toGoalMm === undefined ? undefined : { toGoalMm, ...place };
      });
    };
    const up = (event: PointerEvent): void => {
      if (stroke) {
        stroke = undefined;
        event.stopPropagation();
        return;
      }
      if (!element.contains(event.target as Node) || event.button !== 0) return;
      if (Math.hypot(event.clientX - downX, event.clientY - downY) > clickPixels) return;
      const hit = shownScene.value?.hit(event.clientX, event.clientY);
      if (hit) click(hit.point);
    };
    // Before the toolkit hears of it: a stroke of the brush must not turn the face.
    outer.addEventListener("pointerdown", down, true);
    outer.addEventListener("pointermove", move, true);
    outer.addEventListener("pointerup", up, true);
    outer.addEventListener("pointerleave", leave);
    return () => {
      cancelAnimationFrame(due);
      outer.removeEventListener("pointerdown", down, true);
      outer.removeEventListener("pointermove", move, true);
      outer.removeEventListener("pointerup", up, true);
      outer.removeEventListener("pointerleave", leave);
    };
  }, [main]);
}
