// Step 2: what the face is to look like, and what it lacks to that.
import { useEffect } from "preact/hooks";
import { ScanUnit } from "@wire/plan_pb";
import { FaceSide } from "@wire/planning_service_pb";
import type { Scan } from "@wire/patient_service_pb";
import { busy, tell } from "../activity";
import { region, scan } from "../plan/state";
import { listTargets, mirrorHealthySide, openTarget, takeSurface } from "../target/make_target";
import { earlierTargets, forgetTarget, target, wanted } from "../target/state";
import { CheckField, Complaint, FileButton, Section, Segmented, SelectField } from "../widgets/fields";
import { Missing } from "./missing";
import { units } from "./units";

const sides = [
  { value: "right", label: "Right side" },
  { value: "left", label: "Left side" },
] as const;

function Mirror() {
  const landmarks = Object.keys(region.value?.landmarksMm ?? {}).length;
  const isRight = wanted.value.healthySide === FaceSide.RIGHT;
  return (
    <Section title="Mirror the healthy side">
      <p class="hint">
        The healthy side, mirrored, shows what the other one should look like. Sides are the patient's own.
      </p>
      <Segmented
        label="Healthy side"
        value={isRight ? "right" : "left"}
        options={[...sides]}
        onChange={(side) =>
          (wanted.value = { ...wanted.value, healthySide: side === "right" ? FaceSide.RIGHT : FaceSide.LEFT })
        }
      />
      <button
        type="button"
        class="button primary wide"
        disabled={busy.value !== undefined || landmarks === 0}
        onClick={() => void mirrorHealthySide()}
      >
        Mirror the {isRight ? "right" : "left"} side
      </button>
      {landmarks === 0 && (
        <p class="hint">The landmarks of the face are needed for this: set them in the first step.</p>
      )}
      <Complaint field="target" />
    </Section>
  );
}

function Surface() {
  const { unit, inPlace } = wanted.value;
  return (
    <Section title="Or take another scan of this face">
      <p class="hint">An earlier scan, one after the operation, or one that was sculpted.</p>
      <SelectField
        label="Unit of the goal's file"
        value={unit}
        options={units}
        onChange={(value) => (wanted.value = { ...wanted.value, unit: Number(value) as ScanUnit })}
      />
      <CheckField
        label="It lies on the face already: do not move it"
        value={inPlace}
        onChange={(value) => (wanted.value = { ...wanted.value, inPlace: value })}
      />
      <FileButton
        label="Take a scan as the goal…"
        accept=".obj,.ply,.stl"
        onFiles={async ([file]) => void takeSurface(file.name, await file.arrayBuffer())}
      />
    </Section>
  );
}

function timeOf({ createTime }: Scan): string {
  const date = new Date(Number(createTime?.seconds ?? 0n) * 1000);
  return date.toLocaleString("en-GB", { dateStyle: "medium", timeStyle: "short" });
}

const sourceOf = ({ report }: Scan): string =>
  report?.target?.mirroredSide ? `${report.target.mirroredSide} side, mirrored` : "another scan";

function Earlier() {
  const all = earlierTargets.value;
  if (all.length === 0) return null;
  return (
    <Section title="Goals of this face">
      <SelectField
        label="Made earlier"
        value={target.value?.name ?? ""}
        options={[
          { value: "", label: "None" },
          ...all.map((one) => ({ value: one.name, label: `${sourceOf(one)}, ${timeOf(one)}` })),
        ]}
        onChange={(name) => {
          const next = all.find((one) => one.name === name);
          if (next) void openTarget(next);
          else forgetTarget();
        }}
      />
    </Section>
  );
}

/** How the goal was placed, in the words of who has to trust it. */
function Placement() {
  const report = target.value?.report?.target;
  const found = report?.registration;
  if (!report || !found) return null;
  const over = `${(100 * found.overlap).toFixed(0)} % of the skin lies over it, half of that within ${found.medianMm.toFixed(2)} mm`;
  if (report.mirroredSide) {
    const { turnedDegrees = 0, movedMm = 0 } = report.plane ?? {};
    return (
      <p class="quiet">
        The goal is the {report.mirroredSide} side, mirrored: {over}. The plane of symmetry is that of the landmarks,
        turned by {turnedDegrees.toFixed(1)}° and moved by {movedMm.toFixed(1)} mm until both sides fit.
      </p>
    );
  }
  return (
    <p class="quiet">
      The goal is another scan of this face. It was{" "}
      {found.start === "in place" ? "left where it lies" : "laid onto the face"}: {over}. It may be off by{" "}
      {found.expectedErrorMm.toFixed(2)} mm (confidence {(100 * found.confidence).toFixed(0)} %).
    </p>
  );
}

export function GoalPanel() {
  const face = scan.value?.name;
  useEffect(() => void listTargets().catch(tell), [face]);
  if (face === undefined)
    return (
      <Section title="Goal">
        <p class="hint">There is no face yet. Begin with the first step.</p>
      </Section>
    );
  return (
    <>
      {target.value && (
        <Section title="Goal">
          <Placement />
        </Section>
      )}
      <Missing />
      <Mirror />
      <Surface />
      <Earlier />
    </>
  );
}
