// The picture: the face, what a click does on it, the scalar bar, the probe, before and after.
import { effect } from "@preact/signals";
import { countPictures } from "./picture_rate";
import { useEffect, useRef } from "preact/hooks";
import { brushMm, tool, toolHint } from "../plan/tools";
import { FaceScene } from "../scene/face_scene";
import { beside, bindBeside, titleOf } from "../run/beside";
import { simulation } from "../run/state";
import { bindCamera } from "./camera";
import { Labels } from "./labels";
import { RulerPanel } from "./ruler_panel";
import { bindRulers } from "./rulers";
import { SectionPanel } from "./section_panel";
import { bindSection } from "./section_state";
import { bindGuesses } from "../landmarks/state";
import { bindForecast } from "./forecast_binding";
import { ForecastBar, ForecastProbe } from "./forecast_tools";
import { bindFace, bindFrame, bindMarkers, bindPatch } from "./stage_bindings";
import { useCursor } from "./stage_cursor";
import { onStageFocus, onStageKey } from "./stage_keys";
import {
  compare,
  dark,
  goalProbe,
  keyCursor,
  map,
  presenting,
  probe,
  quantity,
  shownScene,
  split,
} from "./stage_state";
import { ScalarBar } from "./scalar_bar";
import { ShapeReadout } from "./shape_readout";
import { shownDistances, showsFrame } from "./shown";
import { ViewTools } from "./view_tools";

function Probe() {
  const now = probe.value;
  if (!now) return null;
  return (
    <div class="probe" style={{ left: `${now.x + 14}px`, top: `${now.y + 14}px` }}>
      <b>{now.displacementMm.toFixed(2)} mm</b> displaced
      {now.thicknessMm > 0.06 && (
        <>
          <br />
          <b>{now.pressureMmHg.toFixed(1)} mmHg</b> in {now.thicknessMm.toFixed(2)} mm of fat
        </>
      )}
      {now.distanceMm !== undefined && (
        <>
          <br />
          <b>{now.distanceMm.toFixed(2)} mm</b> from the goal
        </>
      )}
    </div>
  );
}

function KeyCursor() {
  const at = keyCursor.value;
  if (!at || tool.value.kind === "turn") return null;
  return <div class="key-cursor" aria-hidden="true" style={{ left: `${at.x}px`, top: `${at.y}px` }} />;
}

function GoalProbe() {
  const now = goalProbe.value;
  if (!now) return null;
  return (
    <div class="probe" style={{ left: `${now.x + 14}px`, top: `${now.y + 14}px` }}>
      <b>{Math.abs(now.toGoalMm).toFixed(1)} mm</b> {now.toGoalMm < 0 ? "missing" : "too much"}
    </div>
  );
}

function Slider() {
  return (
    <>
      <div
        class="divider"
        style={{ left: `${100 * split.value}%` }}
        onPointerDown={(event) => {
          event.preventDefault();
          event.currentTarget.setPointerCapture(event.pointerId);
        }}
        onPointerMove={(event) => {
          if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
          const { left, width } = event.currentTarget.parentElement!.getBoundingClientRect();
          split.value = Math.min(1, Math.max(0, (event.clientX - left) / width));
        }}
      />
      <input
        class="split"
        type="range"
        min={0}
        max={1}
        step={0.01}
        value={split.value}
        aria-label="Share of the picture before"
        onInput={(event) => (split.value = Number(event.currentTarget.value))}
      />
    </>
  );
}

export function Stage() {
  const main = useRef<HTMLDivElement>(null);
  const before = useRef<HTMLDivElement>(null);
  const whole = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const scene = new FaceScene(main.current!);
    scene.onMap = (next) => (map.value = next);
    shownScene.value = scene;
    const ends = [
      countPictures(scene, whole.current!),
      bindFace(scene),
      bindPatch(scene),
      bindMarkers(scene),
      bindFrame(scene),
      effect(() => scene.compare(compare.value === "after" ? undefined : before.current!)),
      effect(() => {
        const other = beside.value?.meshes.get(beside.value.mesh);
        scene.setOther(other && { mesh: other, frame: beside.value!.frame });
      }),
      bindCamera(),
      effect(() => void (scene.dark = presenting.value && dark.value)),
      bindRulers(),
      bindSection(),
      bindForecast(scene),
      bindBeside(),
      bindGuesses(),
    ];
    return () => {
      ends.forEach((end) => end());
      shownScene.value = undefined;
      scene.dispose();
    };
  }, []);
  useCursor(main);
  const mode = compare.value;
  const hint = toolHint(tool.value);
  const comparing = mode !== "after";
  return (
    <div class={`stage mode-${mode}`} ref={whole} data-tool={tool.value.kind}>
      <div
        class="view before"
        ref={before}
        role="application"
        hidden={!comparing}
        aria-label={beside.value ? "Another result, in three dimensions" : "The face before, in three dimensions"}
        style={mode === "slider" ? { clipPath: `inset(0 ${100 * (1 - split.value)}% 0 0)` } : {}}
      />
      <div
        class="view after"
        ref={main}
        tabIndex={0}
        role="application"
        aria-label="The face, in three dimensions: drag or arrow keys turn it, wheel or plus and minus come nearer; with a tool arrow keys lead it and Enter uses it"
        onKeyDown={onStageKey}
        onFocus={onStageFocus}
        onBlur={() => (keyCursor.value = undefined)}
      />
      {comparing && (
        <>
          <span class="tag tag-before">{beside.value?.title ?? "Before"}</span>
          <span class="tag tag-after">{beside.value && simulation.value ? titleOf(simulation.value) : "After"}</span>
        </>
      )}
      {mode === "slider" && <Slider />}
      {hint && (
        <div class="tool-hint" role="status">
          {hint}
          {tool.value.kind === "paint" && ` (${brushMm.value} mm)`}
          <button type="button" class="link" onClick={() => (tool.value = { kind: "turn" })}>
            Done
          </button>
        </div>
      )}
      {quantity.value !== "none" && map.value && showsFrame.value && !shownDistances.value && (
        <ScalarBar map={map.value} quantity={quantity.value} />
      )}
      <ForecastBar />
      {shownDistances.value && <ScalarBar map={shownDistances.value.map} quantity="distance" />}
      <KeyCursor />
      <Probe />
      <GoalProbe />
      <ForecastProbe />
      <Labels />
      <ShapeReadout />
      <div class="stage-panels">
        <RulerPanel />
        <SectionPanel />
      </div>
      <ViewTools />
    </div>
  );
}
