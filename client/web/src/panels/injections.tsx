// What goes into the zones: how much of it under sliders, how fast, and where.
import type { Injection } from "@wire/simulation_pb";
import { readable } from "../plan/anatomy";
import { newInjection } from "../plan/new_plan";
import { editPlan, plan, zones } from "../plan/state";
import { tool } from "../plan/tools";
import { dragVolume, mostOf, releaseVolume } from "../shape/plan_volumes";
import { dragged } from "../shape/state";
import { Many, mostShown } from "./many_injections";
import { Complaint, NumberField, Section, SelectField } from "../widgets/fields";
import { VolumeSlider } from "../widgets/volume_slider";

/** As it is under the hand, else as the plan has it. */
const volumeOf = (injection: Injection, index: number): number | undefined =>
  dragged.value.get(index) ?? injection.volumeMl;

interface OfInjection {
  injection: Injection;
  index: number;
}

/** Alone, as the slider: only they are drawn again while it is dragged. */
function Volume({ injection, index }: OfInjection) {
  return (
    <NumberField
      label="Volume"
      unit="mL"
      step={0.1}
      value={volumeOf(injection, index)}
      field={`simulation.injections[${index}].volume_ml`}
      onChange={(value) => editPlan(({ simulation }) => (simulation!.injections[index].volumeMl = value))}
    />
  );
}

/** Its end is that of the volume before the drag. */
function Slider({ injection, index }: OfInjection) {
  const planned = injection.volumeMl ?? 0;
  const most = mostOf(planned);
  return (
    <VolumeSlider
      label={`Volume of injection ${index + 1}, ${readable(injection.zone)}`}
      value={volumeOf(injection, index) ?? 0}
      min={planned < 0 ? -most : 0}
      max={most}
      onDrag={(volumeMl) => dragVolume(index, volumeMl)}
      onRelease={(volumeMl) => releaseVolume(index, volumeMl)}
    />
  );
}

/** What a volume below 0 takes out. */
function Removal({ injection, index }: OfInjection) {
  const volumeMl = volumeOf(injection, index) ?? 0;
  if (volumeMl >= 0) return null;
  return (
    <p class="hint">
      Takes {(-volumeMl).toFixed(2)} mL of fat out of {readable(injection.zone)}, as far as there is any by then: what
      cannot be taken out is said with the result.
    </p>
  );
}

function Total() {
  const injections = plan.value.simulation?.injections ?? [];
  const total = injections.reduce((sum, injection, index) => sum + (volumeOf(injection, index) ?? 0), 0);
  return <b class="total">{total.toFixed(1)} mL</b>;
}

export function Injections() {
  const injections = plan.value.simulation?.injections ?? [];
  const names = zones.value.map(({ zone }) => zone.name);
  if (injections.length > mostShown)
    return (
      <Section title="Injections" aside={<Total />}>
        <Many injections={injections} />
        <Complaint field="simulation.injections" />
      </Section>
    );
  return (
    <Section title="Injections" aside={<Total />}>
      {injections.map((injection, index) => {
        const at = `simulation.injections[${index}]`;
        const placing = tool.value.kind === "site" && tool.value.index === index;
        return (
          <fieldset class="injection" key={index}>
            <legend>Injection {index + 1}</legend>
            <SelectField
              label="Into"
              value={injection.zone}
              field={`${at}.zone`}
              options={names.map((name) => ({ value: name, label: readable(name) }))}
              onChange={(value) => editPlan(({ simulation }) => (simulation!.injections[index].zone = value))}
            />
            <div class="pair">
              <Volume injection={injection} index={index} />
              <NumberField
                label="Rate"
                unit="mL/s"
                step={0.1}
                value={injection.rateMlPerS}
                field={`${at}.rate_ml_per_s`}
                onChange={(value) => editPlan(({ simulation }) => (simulation!.injections[index].rateMlPerS = value))}
              />
            </div>
            <Slider injection={injection} index={index} />
            <Removal injection={injection} index={index} />
            <div class="row">
              <button
                type="button"
                class="button small"
                aria-pressed={placing}
                onClick={() => (tool.value = placing ? { kind: "turn" } : { kind: "site", index })}
              >
                {injection.site ? "Move the point" : "Place the point"}
              </button>
              {injection.site && (
                <button
                  type="button"
                  class="link"
                  onClick={() => editPlan(({ simulation }) => (simulation!.injections[index].site = undefined))}
                >
                  Evenly over the zone
                </button>
              )}
              <button
                type="button"
                class="link"
                onClick={() => editPlan(({ simulation }) => void simulation!.injections.splice(index, 1))}
              >
                Remove
              </button>
            </div>
            <Complaint field={`${at}.site`} />
          </fieldset>
        );
      })}
      <button
        type="button"
        class="button wide"
        disabled={names.length === 0}
        onClick={() => editPlan(({ simulation }) => void simulation!.injections.push(newInjection(names[0])))}
      >
        Add an injection
      </button>
      {names.length === 0 && <p class="hint">Add a zone first.</p>}
    </Section>
  );
}
