// Step 1: whose face, and where its landmarks are.
import { landmarkHints, landmarkNames, readable } from "../plan/anatomy";
import { takeLandmarks, takePlan } from "../plan/actions";
import { writeMarkups } from "../plan/landmark_files";
import { pointOf, writeLandmarks } from "../plan/landmarks";
import { parsePlan } from "../plan/plan_file";
import { editPlan, plan, region, scan } from "../plan/state";
import { tell } from "../activity";
import { tool } from "../plan/tools";
import { save } from "../run/exports";
import { FileButton, Section, TextField } from "../widgets/fields";
import { CaseSection } from "./case_section";

function Landmarks() {
  const points = region.value?.landmarksMm ?? {};
  const names = [...new Set([...landmarkNames, ...Object.keys(points)])];
  const placing = tool.value.kind === "landmark" ? tool.value.name : "";
  return (
    <Section title="Landmarks" aside={<span class="quiet">{Object.keys(points).length} set</span>}>
      <div class="row">
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
      <ul class="landmarks">
        {names.map((name) => (
          <li key={name} class={points[name] ? "set" : ""}>
            <button
              type="button"
              aria-pressed={placing === name}
              title={landmarkHints[name.replace(/_(left|right)$/, "")] ?? ""}
              onClick={() => (tool.value = placing === name ? { kind: "turn" } : { kind: "landmark", name })}
            >
              <span class="dot" aria-hidden="true" />
              {readable(name)}
            </button>
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
