// Volumes that fill what is missing: asked for within bounds, then picked from a curve.
import { busy } from "../activity";
import { readable } from "../plan/anatomy";
import { plainWords } from "../plan/field_words";
import { modelIsCurrent, plan, zones } from "../plan/state";
import { mmHgPerPa } from "../scene/colour_maps";
import { step } from "../stage/stage_state";
import { pick, propose, question, type Question } from "../target/proposals";
import { deficit, pickedPoint, proposal, target } from "../target/state";
import { CheckField, Complaint, NumberField, Section, SelectField } from "../widgets/fields";
import { TradeOffCurve } from "../widgets/trade_off";

const ask = (change: Partial<Question>): void => void (question.value = { ...question.value, ...change });

function Bounds() {
  const { maxTotalMl, maxZoneMl, maxPressureMmHg, maxLiftMm } = question.value;
  return (
    <div class="pair">
      <NumberField
        label="In all, at most"
        unit="mL"
        min={0}
        placeholder="none"
        value={maxTotalMl}
        field="proposal.bounds.max_total_ml"
        onChange={(value) => ask({ maxTotalMl: value })}
      />
      <NumberField
        label="A zone, at most"
        unit="mL"
        min={0}
        placeholder="none"
        value={maxZoneMl}
        field="proposal.bounds.max_zone_ml"
        onChange={(value) => ask({ maxZoneMl: value })}
      />
      <NumberField
        label="Pressure, at most"
        unit="mmHg"
        min={0}
        placeholder="none"
        value={maxPressureMmHg}
        field="proposal.bounds.max_pressure_pa"
        onChange={(value) => ask({ maxPressureMmHg: value })}
      />
      <NumberField
        label="Skin rises at most"
        unit="mm"
        min={0}
        placeholder="none"
        value={maxLiftMm}
        field="proposal.bounds.max_lift_mm"
        onChange={(value) => ask({ maxLiftMm: value })}
      />
    </div>
  );
}

function Choices() {
  const { addZones, belowLayer, holdsBelowMmHg } = question.value;
  const layers = plan.value.model?.layers ?? [];
  return (
    <>
      <CheckField
        label="Draw zones where something is missing"
        value={addZones}
        onChange={(value) => ask({ addZones: value })}
      />
      {addZones && (
        <SelectField
          label="New zones lie under"
          value={belowLayer}
          field="proposal.zones"
          options={[
            { value: "", label: "Any layer" },
            ...layers.map(({ name }) => ({ value: name, label: readable(name) })),
          ]}
          onChange={(value) => ask({ belowLayer: value })}
        />
      )}
      <Bounds />
      <CheckField
        label="Hold a pressure in 95 of 100 cases of softer or stiffer tissue"
        value={holdsBelowMmHg !== undefined}
        onChange={(value) => ask({ holdsBelowMmHg: value ? 15 : undefined })}
      />
      {holdsBelowMmHg !== undefined && (
        <NumberField
          label="That pressure"
          unit="mmHg"
          min={0}
          value={holdsBelowMmHg}
          field="proposal.spread.pressure_band_pa"
          onChange={(value) => ask({ holdsBelowMmHg: value })}
        />
      )}
    </>
  );
}

function Reached() {
  const found = proposal.value!;
  const [before, after] = [found.before!, found.reached!];
  const held = found.robustness;
  return (
    <>
      <table class="figures-table">
        <thead>
          <tr>
            <th scope="col">Skin that lacks something</th>
            <th scope="col">now</th>
            <th scope="col">proposed</th>
          </tr>
        </thead>
        <tbody>
          <tr>
            <th scope="row">Missing, mL</th>
            <td>{before.volume!.deficitMl.toFixed(1)}</td>
            <td data-proposal="missing">{after.volume!.deficitMl.toFixed(1)}</td>
          </tr>
          <tr>
            <th scope="row">From the goal (RMS), mm</th>
            <td data-proposal="rms-before">{before.skinToTarget!.rmsMm.toFixed(2)}</td>
            <td data-proposal="rms">{after.skinToTarget!.rmsMm.toFixed(2)}</td>
          </tr>
          <tr>
            <th scope="row">95 of 100 places within, mm</th>
            <td>{before.skinToTarget!.p95Mm.toFixed(2)}</td>
            <td>{after.skinToTarget!.p95Mm.toFixed(2)}</td>
          </tr>
        </tbody>
      </table>
      <p class="quiet">
        {found.totalMl.toFixed(1)} mL in {found.volumes.length} {found.volumes.length === 1 ? "zone" : "zones"}, up to{" "}
        {(found.maxPressurePa * mmHgPerPa).toFixed(1)} mmHg at rest; the skin rises by up to{" "}
        {found.maxLiftMm.toFixed(1)} mm. Found in {found.wallS.toFixed(1)} s.
      </p>
      {held && (
        <p class="quiet">
          It holds in {held.membersBelow} of {held.members} cases of tissue (up to{" "}
          {(held.pressureQuantilePa * mmHgPerPa).toFixed(1)} mmHg). Without that it would be{" "}
          {held.nominalTotalMl.toFixed(1)} mL, which holds in {held.nominalMembersBelow}.
        </p>
      )}
      {found.remainders.length > 0 && (
        <details>
          <summary>What stays missing, and why</summary>
          <ul class="plain-list">
            {found.remainders.map(({ description }) => (
              <li key={description}>{plainWords(description, plan.value)}</li>
            ))}
          </ul>
        </details>
      )}
      {found.remarks.map((text) => (
        <p class="hint" key={text}>
          {plainWords(text, plan.value)}
        </p>
      ))}
    </>
  );
}

/** Why a zone has no more, or no less. */
function heldBy(bound: string, volumeMl: number): string {
  if (volumeMl === 0) return ", not needed";
  const words: Record<string, string> = {
    min_zone_ml: "at the least that you allow",
    max_zone_ml: "at the most that you allow",
    max_total_ml: "held by the volume in all",
    max_pressure_pa: "held by the pressure",
    max_lift_mm: "held by how far the skin may rise",
  };
  return bound === "" ? "" : `, ${words[bound] ?? "held by your bound"}`;
}

/** The volumes of the point that is in the plan. */
function Volumes() {
  const point = proposal.value?.curve[pickedPoint.value ?? -1];
  if (!point) return <p class="warning">The plan was changed since. Pick a point to have its volumes again.</p>;
  return (
    <table class="figures-table">
      <thead>
        <tr>
          <th scope="col">In the plan now</th>
          <th scope="col">mL</th>
          <th scope="col">mmHg</th>
        </tr>
      </thead>
      <tbody>
        {point.volumes.map(({ zone, belowLayer, volumeMl, pressurePa, bound }) => (
          <tr key={zone}>
            <th scope="row">
              {readable(zone)} <span class="quiet">under {readable(belowLayer).toLowerCase()}</span>
              <span class="quiet">{heldBy(bound, volumeMl)}</span>
            </th>
            <td>{volumeMl.toFixed(2)}</td>
            <td>{(pressurePa * mmHgPerPa).toFixed(1)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

export function ProposalSection() {
  if (!target.value || !deficit.value) {
    return (
      <Section title="Proposal">
        <p class="hint">
          With a goal, volumes that reach it can be proposed.{" "}
          <button type="button" class="link" onClick={() => (step.value = "goal")}>
            Set a goal
          </button>
        </p>
      </Section>
    );
  }
  const hasNothing = zones.value.length === 0 && !question.value.addZones;
  return (
    <Section title="Proposal">
      <p class="hint">{deficit.value.all!.volume!.deficitMl.toFixed(1)} mL are missing to the goal.</p>
      <Choices />
      <button
        type="button"
        class="button primary wide"
        disabled={busy.value !== undefined || !modelIsCurrent.value || hasNothing}
        onClick={() => void propose()}
      >
        Propose volumes
      </button>
      {!modelIsCurrent.value && <p class="hint">The model of the tissue has to be built first.</p>}
      {hasNothing && <p class="hint">Add a zone below, or let zones be drawn.</p>}
      <Complaint field="proposal" />
      {proposal.value && (
        <>
          <TradeOffCurve
            curve={proposal.value.curve}
            proposed={proposal.value.proposedPoint}
            picked={pickedPoint.value}
            onPick={pick}
          />
          <Volumes />
          <Reached />
        </>
      )}
    </Section>
  );
}
