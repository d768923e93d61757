// Whose face it is: a new patient's scan, or a case that the daemon has.
import { computed, signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import type { Patient, Scan } from "@wire/patient_service_pb";
import { ScanUnit } from "@wire/plan_pb";
import { busy, tell } from "../activity";
import { patients as calls } from "../api/client";
import { closeCase, uploadAnother, uploadFace } from "../case/face";
import { openCase, openSample, openScan } from "../case/open";
import { patient, patientName, scan } from "../plan/state";
import { FileButton, Section, SelectField } from "../widgets/fields";
import { units } from "./units";

const known = signal<Patient[]>([]);
const scansOf = signal<Scan[]>([]);
export const unit = signal(ScanUnit.MILLIMETRE);

async function load(): Promise<void> {
  try {
    known.value = (await calls.listPatients({ pageSize: 1000 })).patients;
    const parent = patient.value;
    const { scans } = parent === "" ? { scans: [] } : await calls.listScans({ parent, pageSize: 1000 });
    // Goals have a list of their own.
    if (parent === patient.value) scansOf.value = scans.filter(({ complete, report }) => complete && !report?.target);
  } catch (error) {
    tell(error);
  }
}

const shortName = (name: string): string => name.split("/").pop()!;

const options = computed(() => {
  const all = known.value.map(({ name, displayName }) => ({ value: name, label: displayName || shortName(name) }));
  const isKnown = patient.value === "" || all.some(({ value }) => value === patient.value);
  const own = { value: patient.value, label: patientName.value || shortName(patient.value) };
  return [{ value: "", label: "New patient" }, ...all, ...(isKnown ? [] : [own])];
});

/** The page at a face: its size says whether the unit is right. */
function Size() {
  const report = scan.value?.report;
  if (!report) return null;
  const size = [report.sizeXMm, report.sizeYMm, report.sizeZMm].map((v) => v.toFixed(0)).join(" × ");
  return (
    <>
      <p class="quiet">
        {report.vertices.toLocaleString("en")} vertices, {size} mm
      </p>
      {[...report.readRemarks, ...report.mendingRemarks].map((remark) => (
        <p class="hint" key={remark}>
          {remark}
        </p>
      ))}
    </>
  );
}

function Scans() {
  if (scansOf.value.length < 2) return null;
  return (
    <SelectField
      label="Scan"
      value={scan.value?.name ?? ""}
      onChange={(name) => name !== "" && void openScan(name)}
      options={[
        ...(scan.value ? [] : [{ value: "", label: "Choose…" }]),
        ...scansOf.value.map(({ name, report }) => ({
          value: name,
          label: `${shortName(name)} (${report?.vertices ?? 0} vertices)`,
        })),
      ]}
    />
  );
}

export function CaseSection() {
  const [face, of] = [scan.value?.name, patient.value];
  useEffect(() => void load(), [face, of]);
  return (
    <Section title="Face">
      <div class="row wrap">
        <FileButton
          label="Upload scan…"
          accept=".obj,.ply,.stl"
          onFiles={async ([file]) => void uploadFace(file.name, await file.arrayBuffer(), unit.value)}
        />
        <button type="button" class="button" disabled={busy.value !== undefined} onClick={() => void openSample()}>
          Synthetic sample
        </button>
      </div>
      <p class="hint">A scan that is uploaded begins the case of a new patient.</p>
      <SelectField
        label="Unit of the file"
        value={unit.value}
        onChange={(value) => (unit.value = Number(value))}
        options={units}
      />
      <SelectField
        label="Patient"
        value={of}
        onChange={(name) => void (name === "" ? closeCase() : openCase(name))}
        options={options.value}
      />
      {of !== "" && (
        <FileButton
          label="Another scan of this patient…"
          accept=".obj,.ply,.stl"
          onFiles={async ([file]) => void uploadAnother(file.name, await file.arrayBuffer(), unit.value)}
        />
      )}
      <Scans />
      <Size />
    </Section>
  );
}
