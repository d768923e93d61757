// What the face lacks to its goal: in all, and by region of the face.
import type { RegionDeficit } from "@wire/planning_service_pb";
import { busy } from "../activity";
import { plainWords, sentence } from "../plan/field_words";
import { plan } from "../plan/state";
import { readable } from "../plan/anatomy";
import { measureAgain } from "../target/make_target";
import { deficit, deficitIsOld, goalView, type GoalView } from "../target/state";
import { Section, Segmented } from "../widgets/fields";

/** What is less than this in a region is what scans are off by. */
const leastMl = 0.05;
/** So many regions are listed at once; those with less come after. */
const firstRegions = 6;

function Table({ regions }: { regions: RegionDeficit[] }) {
  return (
    <table class="figures-table">
      <thead>
        <tr>
          <th scope="col">Region</th>
          <th scope="col">missing mL</th>
          <th scope="col">at most mm</th>
        </tr>
      </thead>
      <tbody>
        {regions.map(({ region, volume, maxDeficitMm }) => (
          <tr key={region}>
            <th scope="row">{readable(region)}</th>
            <td>{volume!.deficitMl.toFixed(1)}</td>
            <td>{maxDeficitMm.toFixed(1)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Regions() {
  const regions = (deficit.value?.regions ?? [])
    .filter(({ volume }) => (volume?.deficitMl ?? 0) >= leastMl)
    .sort((a, b) => b.volume!.deficitMl - a.volume!.deficitMl);
  if (deficit.value?.regions.length === 0)
    return <p class="hint">Set the landmarks of the face to see this by region.</p>;
  if (regions.length === 0) return <p class="hint">No region of the face lacks {leastMl} mL or more.</p>;
  const rest = regions.slice(firstRegions);
  return (
    <>
      <Table regions={regions.slice(0, firstRegions)} />
      {rest.length > 0 && (
        <details>
          <summary>{rest.length} regions that lack less</summary>
          <Table regions={rest} />
        </details>
      )}
      <p class="quiet">Regions overlap: their volumes do not add up.</p>
    </>
  );
}

const views: { value: GoalView; label: string }[] = [
  { value: "missing", label: "Missing" },
  { value: "target", label: "Goal" },
  { value: "face", label: "Face" },
];

export function Missing() {
  const all = deficit.value?.all;
  if (!all) return null;
  const symmetry = deficit.value!.symmetryIndexMm;
  return (
    <Section title="Missing on the face">
      <Segmented
        label="Show on the face"
        value={goalView.value}
        options={views}
        onChange={(v) => (goalView.value = v)}
      />
      <dl class="headline">
        <div>
          <dt>Missing</dt>
          <dd data-deficit="missing">
            {all.volume!.deficitMl.toFixed(1)} <small>mL</small>
          </dd>
        </div>
        <div>
          <dt>Too much</dt>
          <dd>
            {all.volume!.excessMl.toFixed(1)} <small>mL</small>
          </dd>
        </div>
        <div>
          <dt>Deepest</dt>
          <dd>
            {all.maxDeficitMm.toFixed(1)} <small>mm</small>
          </dd>
        </div>
        <div>
          <dt>Off by (RMS)</dt>
          <dd>
            {all.distance!.rmsMm.toFixed(2)} <small>mm</small>
          </dd>
        </div>
      </dl>
      <Regions />
      {symmetry !== undefined && (
        <p class="quiet">
          The face is {symmetry.toFixed(2)} mm from its own mirror image; healthy faces are 0.3 to 1 mm from theirs.
        </p>
      )}
      {deficit.value!.remarks.map((text) => (
        <p class="hint" key={text}>
          {sentence(plainWords(text, plan.value))}
        </p>
      ))}
      {deficitIsOld.value && (
        <>
          <p class="warning">Landmarks have moved since this was measured.</p>
          <button type="button" class="button" disabled={busy.value !== undefined} onClick={() => void measureAgain()}>
            Measure again
          </button>
        </>
      )}
    </Section>
  );
}
