// The planner: five steps beside the picture.
import { effect } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { busy, problem, remark } from "./activity";
import { bindPlanCheck } from "./plan/check";
import { plainWords, sentence } from "./plan/field_words";
import { modelIsCurrent, plan, violations } from "./plan/state";
import { elsewhere } from "./plan/violations";
import { tool } from "./plan/tools";
import { connection, distance, refusals } from "./run/state";
import { bindShape } from "./shape/plan_volumes";
import { FacePanel } from "./panels/face_panel";
import { FatPanel } from "./panels/fat_panel";
import { Figures } from "./panels/figures";
import { GoalPanel } from "./panels/goal_panel";
import { Invitation } from "./panels/invitation";
import { faceIsDone, fatIsDone, isEmpty, runIsDone } from "./progress";
import { deficit, deficitIsOld } from "./target/state";
import { complaintsElsewhere, complaintsHere } from "./widgets/complaints";
import { onKey } from "./keyboard";
import { RunPanel } from "./panels/run_panel";
import { Stage } from "./stage/stage";
import { dark, presenting, quantity, step, type Step } from "./stage/stage_state";
import { Timeline } from "./stage/timeline";
import { TissuePanel } from "./panels/tissue_panel";

const steps: { key: Step; label: string; done: () => boolean }[] = [
  { key: "face", label: "Face", done: () => faceIsDone.value },
  { key: "goal", label: "Goal", done: () => deficit.value !== undefined && !deficitIsOld.value },
  { key: "tissue", label: "Tissue", done: () => modelIsCurrent.value },
  { key: "fat", label: "Fat", done: () => fatIsDone.value },
  { key: "run", label: "Run", done: () => runIsDone.value },
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
      {now.cancel && (
        <button type="button" class="button small" onClick={now.cancel}>
          Cancel
        </button>
      )}
    </div>
  );
}

/** What stands beside its field is not said again. */
function Problem() {
  const now = problem.value;
  if (!now) return null;
  const ofFields = now.violations.length > 0;
  const said = violations.value.length > 0 || refusals.value.length > 0;
  const list = said ? complaintsElsewhere.value : elsewhere(now.violations, [], plan.value);
  return (
    <div class="problem" role="alert">
      <p>{ofFields ? "This cannot be done as it is:" : sentence(plainWords(now.message, plan.value))}</p>
      {ofFields && said && complaintsHere.value && <p>What has to change is marked in the form beside the picture.</p>}
      {ofFields && list.length > 0 && (
        <ul>
          {list.map((text) => (
            <li key={text}>{text}</li>
          ))}
        </ul>
      )}
      <button type="button" class="icon" aria-label="Dismiss" onClick={() => (problem.value = undefined)}>
        ×
      </button>
    </div>
  );
}

function Remark() {
  if (remark.value === "") return null;
  return (
    <div class="remark" role="status">
      <p>{remark.value}</p>
      <button type="button" class="icon" aria-label="Dismiss" onClick={() => (remark.value = "")}>
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
    <main
      class={`planner step-${now} ${presenting.value ? "presenting" : ""} ${presenting.value && dark.value ? "dark" : ""}`}
    >
      <div class="panel">
        <Steps />
        <div class="panel-body" data-violations={violations.value.length}>
          {now === "face" && <FacePanel />}
          {now === "goal" && <GoalPanel />}
          {now === "tissue" && <TissuePanel />}
          {now === "fat" && <FatPanel />}
          {now === "run" && <RunPanel />}
        </div>
      </div>
      <div class="middle">
        <Stage />
        {isEmpty.value && now !== "run" && <Invitation />}
        {now === "run" && <Timeline />}
        {connection.value === "lost" && (
          <div class="lost" role="status">
            Connection lost. Trying again; nothing is lost.
          </div>
        )}
        <Busy />
        <Problem />
        <Remark />
      </div>
      {now === "run" && <Figures />}
    </main>
  );
}
