// What the cursor does over the picture: it probes, clicks places, paints; turning is the
// toolkit's.
import type { RefObject } from "preact";
import { useEffect } from "preact/hooks";
import { drop, moved, openGuesses } from "../landmarks/state";
import { pointOf } from "../plan/landmarks";
import { region } from "../plan/state";
import { click, dab, tool } from "../plan/tools";
import { distanceOf, type Point } from "../scene/surface_geometry";
import { shownForecast } from "../forecast/state";
import { forecastAt } from "./forecast_binding";
import { forecastProbe } from "./forecast_tools";
import { addPlace } from "./rulers";
import { shownDistances, shownFrame } from "./shown";
import { goalProbe, probe, shownScene, step } from "./stage_state";

/** A press that moved further was a turn of the face. */
const clickPixels = 4;
/** So near a landmark is taken by the hand. */
const [grabPixels, grabMm] = [14, 8];

export function useCursor(main: RefObject<HTMLDivElement>): void {
  useEffect(() => {
    const element = main.current!;
    const outer = element.parentElement!;
    let [downX, downY, due] = [0, 0, 0];
    /** of the brush that is down */
    let stroke: object | undefined;
    /** the landmark that is dragged */
    let grabbed: string | undefined;

    const leave = (): void => {
      cancelAnimationFrame(due);
      [probe.value, goalProbe.value, forecastProbe.value] = [undefined, undefined, undefined];
    };
    const paint = (event: PointerEvent): void => {
      const hit = shownScene.value?.hitPatch(event.clientX, event.clientY);
      if (hit) dab(hit.point, stroke);
    };
    /** The landmark or guess under the pointer, on the side of the face that is seen. */
    const landmarkAt = ({ clientX, clientY }: PointerEvent): string | undefined => {
      const scene = shownScene.value;
      const hit = scene?.hit(clientX, clientY);
      if (!scene || !hit || step.value !== "face" || tool.value.kind !== "turn") return undefined;
      const set = Object.entries(region.value?.landmarksMm ?? {}).map(([name, at]) => ({ name, at: pointOf(at) }));
      const open = Object.entries(openGuesses.value).map(([name, { at }]) => ({ name, at }));
      const box = element.getBoundingClientRect();
      const apart = (at: Point): number => {
        const { x, y } = scene.viewport.project(at);
        return Math.hypot(x - (clientX - box.left), y - (clientY - box.top));
      };
      return [...set, ...open]
        .filter(({ at }) => apart(at) < grabPixels && distanceOf(at, hit.point) < grabMm)
        .sort((a, b) => apart(a.at) - apart(b.at))[0]?.name;
    };
    const down = (event: PointerEvent): void => {
      [downX, downY] = [event.clientX, event.clientY];
      probe.value = undefined;
      grabbed = event.button === 0 && element.contains(event.target as Node) ? landmarkAt(event) : undefined;
      if (grabbed !== undefined) {
        event.stopPropagation();
        outer.setPointerCapture(event.pointerId);
        return;
      }
      if (tool.value.kind !== "paint" || event.button !== 0 || !element.contains(event.target as Node)) return;
      if (!shownScene.value?.hitPatch(event.clientX, event.clientY)) return;
      event.stopPropagation();
      outer.setPointerCapture(event.pointerId);
      stroke = {};
      paint(event);
    };
    const move = (event: PointerEvent): void => {
      if (grabbed !== undefined) {
        event.stopPropagation();
        const hit = shownScene.value?.hit(event.clientX, event.clientY);
        const isDrag = Math.hypot(event.clientX - downX, event.clientY - downY) > clickPixels;
        if (hit && (isDrag || moved.value)) moved.value = { name: grabbed, at: hit.point };
        return;
      }
      if (stroke) {
        event.stopPropagation();
        paint(event);
        return;
      }
      if (
        event.buttons !== 0 ||
        tool.value.kind === "measure" ||
        (shownFrame.value === undefined && shownDistances.value === undefined && shownForecast.value === undefined)
      )
        return;
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
        const mm = forecastAt(clientX, clientY);
        forecastProbe.value = mm && { ...mm, ...place };
      });
    };
    const up = (event: PointerEvent): void => {
      if (grabbed !== undefined) {
        grabbed = undefined;
        event.stopPropagation();
        return drop();
      }
      if (stroke) {
        stroke = undefined;
        event.stopPropagation();
        return;
      }
      if (!element.contains(event.target as Node) || event.button !== 0) return;
      if (Math.hypot(event.clientX - downX, event.clientY - downY) > clickPixels) return;
      const hit = shownScene.value?.hit(event.clientX, event.clientY);
      if (hit && tool.value.kind === "measure") addPlace(hit);
      else if (hit) click(hit.point);
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
