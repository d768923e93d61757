// Step 1: whose face, and where its landmarks are.
import { landmarkHints, landmarkNames, readable } from "../plan/anatomy";
import { takeLandmarks, takePlan } from "../plan/actions";
import { writeMarkups } from "../plan/landmark_files";
import { pointOf, writeLandmarks } from "../plan/landmarks";
import { parsePlan } from "../plan/plan_file";
import { editPlan, plan, region, scan } from "../plan/state";
import { busy, tell } from "../activity";
import { confirm, confirmAll, exchangeSides, guess, missing, openGuesses, swapped } from "../landmarks/state";
import { goOn, tool } from "../plan/tools";
import { showLabels } from "../stage/stage_state";
import { save } from "../run/exports";
import { CheckField, FileButton, Section, TextField } from "../widgets/fields";
import { CaseSection } from "./case_section";
import { LandmarkPicture } from "./landmark_picture";

/** A first guess, one click a point in order, and what looks wrong. */
function Assistance() {
  const open = Object.keys(openGuesses.value).length;
  const pairs = swapped.value;
  return (
    <>
      <div class="row wrap">
        <button type="button" class="button" disabled={busy.value !== undefined} onClick={() => void guess()}>
          Guess the landmarks
        </button>
        {missing.value.length > 0 && (
          <button type="button" class="button" onClick={() => goOn()}>
            Place one by one
          </button>
        )}
        {open > 0 && (
          <button type="button" class="button primary" onClick={confirmAll}>
            Confirm {open} guesses
          </button>
        )}
      </div>
      {open > 0 && (
        <p class="hint">
          Guesses are orange. Half of them are nearer than the figure beside them: look at each, drag it where it
          belongs, and confirm.
        </p>
      )}
      {pairs.length > 0 && (
        <div class="warning" role="alert">
          <p>
            Left and right look swapped: {pairs.map((name) => readable(name).toLowerCase()).join(", ")}. Left is the
            patient's left.
          </p>
          <button type="button" class="button small" onClick={exchangeSides}>
            Swap them
          </button>
        </div>
      )}
      <CheckField
        label="Labels on the face"
        value={showLabels.value}
        onChange={(value) => (showLabels.value = value)}
      />
    </>
  );
}

function Guided({ name }: { name: string }) {
  const guided = tool.value.kind === "landmark" && tool.value.guided === true;
  return (
    <div class="guided">
      <LandmarkPicture name={name} />
      <div>
        <p>
          <b>{readable(name)}</b>
        </p>
        <p class="hint">{landmarkHints[name.replace(/_(left|right)$/, "")] ?? ""}</p>
        {guided && (
          <button type="button" class="button small" onClick={() => goOn(name)}>
            Skip
          </button>
        )}
      </div>
    </div>
  );
}

function Landmarks() {
  const points = region.value?.landmarksMm ?? {};
  const names = [...new Set([...landmarkNames, ...Object.keys(points)])];
  const placing = tool.value.kind === "landmark" ? tool.value.name : "";
  return (
    <Section title="Landmarks" aside={<span class="quiet">{Object.keys(points).length} set</span>}>
      <div class="row wrap">
        <FileButton
          label="From file…"
          accept=".json,.fcsv,.pp,.csv,.tsv,.txt"
          onFiles={async ([file]) => {
            try {
              takeLandmarks(await file.text(), undefined, file.name);
            } catch (error) {
              tell(error);
            }
          }}
        />
        <button
          type="button"
          class="button"
          disabled={Object.keys(points).length === 0}
          onClick={() => save("landmarks.json", writeLandmarks(points, region.value?.axes))}
        >
          Save
        </button>
        <button
          type="button"
          class="button"
          title="Markups that 3D Slicer opens, in LPS"
          disabled={Object.keys(points).length === 0}
          onClick={() =>
            save("landmarks.mrk.json", writeMarkups(Object.entries(points).map(([name, at]) => [name, pointOf(at)])))
          }
        >
          Save for Slicer
        </button>
      </div>
      <Assistance />
      {placing !== "" && <Guided name={placing} />}
      <ul class={`landmarks ${Object.keys(openGuesses.value).length > 0 ? "one-column" : ""}`}>
        {names.map((name) => (
          <li key={name} class={points[name] ? "set" : openGuesses.value[name] ? "guessed" : ""}>
            <button
              type="button"
              aria-pressed={placing === name}
              title={landmarkHints[name.replace(/_(left|right)$/, "")] ?? ""}
              onClick={() => (tool.value = placing === name ? { kind: "turn" } : { kind: "landmark", name })}
            >
              <span class="dot" aria-hidden="true" />
              {readable(name)}
              {openGuesses.value[name] && <span class="quiet">±{openGuesses.value[name].uncertaintyMm} mm</span>}
            </button>
            {openGuesses.value[name] && (
              <button
                type="button"
                class="icon"
                title="Confirm the guess"
                aria-label={`Confirm ${readable(name)}`}
                onClick={() => confirm(name)}
              >
                ✓
              </button>
            )}
            {points[name] && (
              <button
                type="button"
                class="icon"
                aria-label={`Remove ${readable(name)}`}
                onClick={() =>
                  editPlan(({ model }) => {
                    if (model?.geometry.case === "scanRegion") delete model.geometry.value.landmarksMm[name];
                  })
                }
              >
                ×
              </button>
            )}
          </li>
        ))}
      </ul>
    </Section>
  );
}

export function FacePanel() {
  return (
    <>
      <CaseSection />
      <Section title="Plan">
        <TextField
          label="Name"
          value={plan.value.name}
          onChange={(name) => name !== "" && editPlan((next) => (next.name = name))}
        />
        <FileButton
          label="Open plan…"
          accept=".json"
          onFiles={async ([file]) => {
            try {
              takePlan(parsePlan(await file.text()));
            } catch (error) {
              tell(error);
            }
          }}
        />
      </Section>
      {scan.value && <Landmarks />}
    </>
  );
}
