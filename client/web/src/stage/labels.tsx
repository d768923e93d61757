// Words on the face: names of landmarks, lengths and angles. They follow the camera.
import { computed } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { readable } from "../plan/anatomy";
import { openGuesses } from "../landmarks/state";
import { pointOf } from "../plan/landmarks";
import { region } from "../plan/state";
import type { Point } from "../scene/surface_geometry";
import { readings, unitOf } from "./rulers";
import { showLabels, shownScene, step } from "./stage_state";

interface Label {
  text: string;
  at: Point;
  kind: "landmark" | "ruler";
}

const middle = (path: Point[]): Point => path[Math.floor(path.length / 2)];
const between = ([a, b]: Point[]): Point => a.map((v, c) => (v + b[c]) / 2) as Point;

const guessed = (): Label[] =>
  step.value !== "face" || !showLabels.value
    ? []
    : Object.entries(openGuesses.value).map(([name, { at }]) => ({ text: `${readable(name)}?`, at, kind: "landmark" }));

const labels = computed<Label[]>(() => {
  const landmarks = step.value === "face" && showLabels.value ? Object.entries(region.value?.landmarksMm ?? {}) : [];
  return [
    ...guessed(),
    ...landmarks.map(([name, at]) => ({ text: readable(name), at: pointOf(at), kind: "landmark" as const })),
    ...readings.value
      .filter(({ value }) => value !== undefined)
      .map(({ ruler, points, path, value }) => ({
        text: `${value!.toFixed(1)}${unitOf(ruler)}`,
        at: ruler === "angle" ? points[1] : ruler === "distance" ? between(points) : middle(path),
        kind: "ruler" as const,
      })),
  ];
});

export function Labels() {
  const box = useRef<HTMLDivElement>(null);
  const all = labels.value;
  useEffect(() => {
    const viewport = shownScene.value?.viewport;
    if (!viewport) return undefined;
    const place = (): void => {
      all.forEach(({ at }, k) => {
        const one = box.current?.children[k] as HTMLElement | undefined;
        if (!one) return;
        const { x, y } = viewport.project(at);
        one.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      });
    };
    viewport.onDrawn.add(place);
    viewport.request();
    return () => void viewport.onDrawn.delete(place);
  }, [all]);
  return (
    <div class="face-labels" ref={box} aria-hidden="true">
      {all.map(({ text, kind }, k) => (
        <span key={k} class={kind}>
          {text}
        </span>
      ))}
    </div>
  );
}
