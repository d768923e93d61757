// The planner: four steps beside the picture.
import { effect } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { busy, problem } from "./activity";
import { bindPlanCheck } from "./plan/check";
import { modelIsCurrent, scan, violations, zones } from "./plan/state";
import { tool } from "./plan/tools";
import { connection, distance, hasResult } from "./run/state";
import { bindShape } from "./shape/plan_volumes";
import { FacePanel } from "./panels/face_panel";
import { FatPanel } from "./panels/fat_panel";
import { Figures } from "./panels/figures";
import { onKey } from "./keyboard";
import { RunPanel } from "./panels/run_panel";
import { Stage } from "./stage/stage";
import { quantity, step, type Step } from "./stage/stage_state";
import { Timeline } from "./stage/timeline";
import { TissuePanel } from "./panels/tissue_panel";

const steps: { key: Step; label: string; done: () => boolean }[] = [
  { key: "face", label: "Face", done: () => scan.value !== undefined },
  { key: "tissue", label: "Tissue", done: () => modelIsCurrent.value },
  { key: "fat", label: "Fat", done: () => zones.value.length > 0 },
  { key: "run", label: "Run", done: () => hasResult.value },
];

function Steps() {
  return (
    <nav class="steps" aria-label="Steps of the plan">
      {steps.map(({ key, label, done }, index) => (
        <button
          type="button"
          key={key}
          aria-current={step.value === key ? "step" : undefined}
          class={done() ? "done" : ""}
          onClick={() => {
            tool.value = { kind: "turn" };
            step.value = key;
          }}
        >
          <span class="number" aria-hidden="true">
            {done() ? "✓" : index + 1}
          </span>
          {label}
        </button>
      ))}
    </nav>
  );
}

function Busy() {
  const now = busy.value;
  if (!now) return null;
  return (
    <div class="busy" role="status">
      <span>{now.label}…</span>
      <progress value={now.share} max={1} aria-label={now.label} />
    </div>
  );
}

function Problem() {
  const now = problem.value;
  if (!now) return null;
  return (
    <div class="problem" role="alert">
      <p>{now.message}</p>
      {now.violations.length > 0 && (
        <ul>
          {now.violations.map(({ field, description }) => (
            <li key={field}>
              <code>{field}</code> {description}
            </li>
          ))}
        </ul>
      )}
      <button type="button" class="icon" aria-label="Dismiss" onClick={() => (problem.value = undefined)}>
        ×
      </button>
    </div>
  );
}

export function Planner() {
  useEffect(() => {
    const ends = [
      bindPlanCheck(() => step.value === "fat"),
      bindShape(),
      effect(() => {
        if (distance.value === undefined && quantity.peek() === "distance") quantity.value = "displacement";
      }),
    ];
    window.addEventListener("keydown", onKey);
    return () => {
      window.removeEventListener("keydown", onKey);
      ends.forEach((end) => end());
    };
  }, []);
  const now = step.value;
  return (
    <main class={`planner step-${now}`}>
      <div class="panel">
        <Steps />
        <div class="panel-body" data-violations={violations.value.length}>
          {now === "face" && <FacePanel />}
          {now === "tissue" && <TissuePanel />}
          {now === "fat" && <FatPanel />}
          {now === "run" && <RunPanel />}
        </div>
      </div>
      <div class="middle">
        <Stage />
        {now === "run" && <Timeline />}
        {connection.value === "lost" && (
          <div class="lost" role="status">
            Connection lost. Trying again; nothing is lost.
          </div>
        )}
        <Busy />
        <Problem />
      </div>
      {now === "run" && <Figures />}
    </main>
  );
}
