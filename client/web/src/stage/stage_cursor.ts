// What the cursor does over the picture: it probes, clicks places, paints; turning is the
// toolkit's.
import type { RefObject } from "preact";
import { useEffect } from "preact/hooks";
import { click, dab, tool } from "../plan/tools";
import { shownFrame } from "./shown";
import { probe, shownScene } from "./stage_state";

/** A press that moved further was a turn of the face. */
const clickPixels = 4;

export function useCursor(main: RefObject<HTMLDivElement>): void {
  useEffect(() => {
    const element = main.current!;
    const outer = element.parentElement!;
    let [painting, downX, downY, due] = [false, 0, 0, 0];

    const leave = (): void => {
      cancelAnimationFrame(due);
      probe.value = undefined;
    };
    const paint = (event: PointerEvent): void => {
      const hit = shownScene.value?.hitPatch(event.clientX, event.clientY);
      if (hit) dab(hit.point);
    };
    const down = (event: PointerEvent): void => {
      [downX, downY] = [event.clientX, event.clientY];
      probe.value = undefined;
      if (tool.value.kind !== "paint" || event.button !== 0 || !element.contains(event.target as Node)) return;
      if (!shownScene.value?.hitPatch(event.clientX, event.clientY)) return;
      event.stopPropagation();
      outer.setPointerCapture(event.pointerId);
      painting = true;
      paint(event);
    };
    const move = (event: PointerEvent): void => {
      if (painting) {
        event.stopPropagation();
        paint(event);
        return;
      }
      if (event.buttons !== 0 || shownFrame.value === undefined) return;
      if (!(event.target as HTMLElement).closest(".view")) return leave();
      const { clientX, clientY } = event;
      cancelAnimationFrame(due);
      due = requestAnimationFrame(() => {
        const found = shownScene.value?.probe(clientX, clientY);
        const box = outer.getBoundingClientRect();
        probe.value = found && { ...found, x: clientX - box.left, y: clientY - box.top };
      });
    };
    const up = (event: PointerEvent): void => {
      if (painting) {
        painting = false;
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
