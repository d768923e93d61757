// Step 1: whose face, and where its landmarks are.
import { useEffect } from "preact/hooks";
import { signal } from "@preact/signals";
import type { Patient, Scan } from "@wire/patient_service_pb";
import { ScanUnit } from "@wire/plan_pb";
import { patients as calls } from "../api/client";
import { landmarkHints, landmarkNames, readable } from "../plan/anatomy";
import { openSample, pickScan, takeLandmarks, takePlan, uploadFace } from "../plan/actions";
import { writeMarkups } from "../plan/landmark_files";
import { pointOf, writeLandmarks } from "../plan/landmarks";
import { parsePlan } from "../plan/plan_file";
import { editPlan, patient, plan, region, scan } from "../plan/state";
import { tell } from "../activity";
import { tool } from "../plan/tools";
import { save } from "../run/exports";
import { FileButton, Section, SelectField, TextField } from "../widgets/fields";

const known = signal<Patient[]>([]);
const scansOf = signal<Scan[]>([]);
const unit = signal(ScanUnit.MILLIMETRE);

async function loadPatients(): Promise<void> {
  try {
    known.value = (await calls.listPatients({ pageSize: 1000 })).patients;
  } catch (error) {
    tell(error);
  }
}

async function choosePatient(name: string): Promise<void> {
  patient.value = name;
  try {
    scansOf.value =
      name === ""
        ? []
        : (await calls.listScans({ parent: name, pageSize: 1000 })).scans.filter(({ complete }) => complete);
  } catch (error) {
    tell(error);
  }
}

const shortName = (name: string): string => name.split("/").pop()!;

function Source() {
  const scanName = scan.value?.name;
  useEffect(() => void loadPatients(), [scanName]);
  return (
    <Section title="Face">
      <div class="row">
        <FileButton
          label="Upload scan…"
          accept=".obj,.ply,.stl"
          onFiles={async ([file]) => void uploadFace(file.name, await file.arrayBuffer(), unit.value)}
        />
        <button type="button" class="button" onClick={() => void openSample()}>
          Synthetic sample
        </button>
      </div>
      <SelectField
        label="Unit of the file"
        value={unit.value}
        onChange={(value) => (unit.value = Number(value))}
        options={[
          { value: ScanUnit.MILLIMETRE, label: "Millimetres" },
          { value: ScanUnit.CENTIMETRE, label: "Centimetres" },
          { value: ScanUnit.METRE, label: "Metres" },
        ]}
      />
      <SelectField
        label="Patient"
        value={patient.value}
        onChange={(value) => void choosePatient(value)}
        options={[
          { value: "", label: "New patient" },
          ...known.value.map(({ name, displayName }) => ({ value: name, label: displayName || shortName(name) })),
        ]}
      />
      {scansOf.value.length > 0 && (
        <SelectField
          label="Scan"
          value={scan.value?.name ?? ""}
          onChange={(value) => {
            const next = scansOf.value.find(({ name }) => name === value);
            if (next) void pickScan(next);
          }}
          options={[
            { value: "", label: "Choose…" },
            ...scansOf.value.map(({ name, report }) => ({
              value: name,
              label: `${shortName(name)} (${report?.vertices ?? 0} vertices)`,
            })),
          ]}
        />
      )}
      {scan.value?.report && (
        <p class="quiet">
          {scan.value.report.vertices.toLocaleString("en")} vertices,{" "}
          {[scan.value.report.sizeXMm, scan.value.report.sizeYMm, scan.value.report.sizeZMm]
            .map((v) => v.toFixed(0))
            .join(" × ")}{" "}
          mm
        </p>
      )}
    </Section>
  );
}

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
      <Source />
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
