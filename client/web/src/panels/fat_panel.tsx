// Step 4: where the fat goes, how much and how fast, and what holds the tissue together.
import { create } from "@bufbuild/protobuf";
import { FatPreset, FatSchema, LigamentSchema, Pace, TimeControl_Goal, TimeControlSchema } from "@wire/simulation_pb";
import { ligamentNames, readable } from "../plan/anatomy";
import { remarks } from "../plan/check";
import { fieldWords, plainWords } from "../plan/field_words";
import { freeName, newFilm } from "../plan/new_plan";
import { editPlan, modelIsCurrent, plan, region } from "../plan/state";
import { tool } from "../plan/tools";
import { CheckField, Complaint, NumberField, Section, SelectField } from "../widgets/fields";
import { DeliverySection } from "./delivery_section";
import { Injections } from "./injections";
import { ProposalSection } from "./proposal_section";
import { FilmEditor } from "./zone_list";

function Planes() {
  const films = plan.value.simulation?.films ?? [];
  let zonesBefore = 0;
  return (
    <Section title="Planes and zones">
      {films.map((film, index) => {
        const before = zonesBefore;
        zonesBefore += film.zones.length;
        return <FilmEditor key={film.name} film={index} of={film} zonesBefore={before} />;
      })}
      <button
        type="button"
        class="link"
        onClick={() =>
          editPlan(({ model, simulation }) => {
            const used = simulation!.films.map(({ belowLayer }) => belowLayer);
            const layer = model!.layers.find(({ name }) => !used.includes(name))?.name ?? model!.layers[0]?.name ?? "";
            simulation!.films.push(
              newFilm(
                freeName(
                  "plane",
                  simulation!.films.map(({ name }) => name),
                ),
                layer,
              ),
            );
          })
        }
      >
        Add a plane
      </button>
    </Section>
  );
}

function Fat() {
  const fat = plan.value.simulation?.fat;
  const preset = fat?.preset ?? FatPreset.FAT_PRESET_UNSPECIFIED;
  return (
    <Section title="Fat">
      <SelectField
        label="Preparation"
        value={preset === FatPreset.FAT_PRESET_UNSPECIFIED ? FatPreset.NEWTONIAN : preset}
        field="simulation.fat"
        onChange={(value) =>
          editPlan(({ simulation }) => (simulation!.fat = create(FatSchema, { preset: Number(value) })))
        }
        options={[
          { value: FatPreset.NEWTONIAN, label: "Evenly viscous" },
          { value: FatPreset.COLEMAN, label: "Coleman" },
          { value: FatPreset.NANOFAT, label: "Nanofat" },
          { value: FatPreset.SVF_GEL, label: "SVF gel" },
        ]}
      />
      {preset <= FatPreset.NEWTONIAN && (
        <NumberField
          label="Viscosity"
          unit="Pa s"
          value={fat?.viscosityPaS}
          placeholder="15"
          field="simulation.fat.viscosity_pa_s"
          onChange={(value) =>
            editPlan(({ simulation }) => ((simulation!.fat ??= create(FatSchema)).viscosityPaS = value))
          }
        />
      )}
    </Section>
  );
}

function Ligaments() {
  const ligaments = plan.value.simulation?.ligaments ?? [];
  const sides = ["left", "right"].filter((side) => region.value?.landmarksMm[`gonion_${side}`]);
  const named = sides.flatMap((side) => ligamentNames.map((name) => `${name}_${side}`));
  const add = (choice: string): void => {
    const name = freeName(
      choice === "points" ? "ligament" : choice,
      ligaments.map((ligament) => ligament.name),
    );
    editPlan(
      ({ simulation }) =>
        void simulation!.ligaments.push(
          create(
            LigamentSchema,
            choice === "points"
              ? { name, stiffnessNPerMm: 0.2, slackMm: 0.5 }
              : { name, place: { case: "anatomical", value: choice }, slackMm: 0.5 },
          ),
        ),
    );
    if (choice === "points") tool.value = { kind: "ligament", index: plan.value.simulation!.ligaments.length - 1 };
  };
  return (
    <Section title="Ligaments">
      <ul class="items">
        {ligaments.map((ligament, index) => {
          const placing = tool.value.kind === "ligament" && tool.value.index === index;
          return (
            <li class="item" key={ligament.name}>
              <span class="grow">
                <b>{readable(ligament.name)}</b>{" "}
                <span class="quiet">
                  {ligament.place.case === "points"
                    ? `${ligament.place.value.points.length} points`
                    : ligament.place.case === "anatomical"
                      ? "by landmarks"
                      : "not placed"}
                </span>
              </span>
              {ligament.place.case !== "anatomical" && (
                <button
                  type="button"
                  class="button small"
                  aria-pressed={placing}
                  onClick={() => (tool.value = placing ? { kind: "turn" } : { kind: "ligament", index })}
                >
                  {placing ? "Done" : "Place"}
                </button>
              )}
              <button
                type="button"
                class="icon"
                aria-label={`Remove ${readable(ligament.name)}`}
                onClick={() => editPlan(({ simulation }) => void simulation!.ligaments.splice(index, 1))}
              >
                ×
              </button>
              <Complaint field={`simulation.ligaments[${index}]`} />
            </li>
          );
        })}
      </ul>
      <SelectField
        label="Add a ligament"
        value=""
        onChange={(value) => value !== "" && add(value)}
        options={[
          { value: "", label: "Choose…" },
          { value: "points", label: "Placed by hand" },
          ...named.map((name) => ({ value: name, label: readable(name) })),
        ]}
      />
    </Section>
  );
}

function Time() {
  const { time, pace, preview } = plan.value.simulation ?? {};
  const settled = time?.goal === TimeControl_Goal.SETTLED_SHAPE;
  return (
    <Section title="Time">
      <CheckField
        label="Watch in real time"
        value={pace === Pace.REAL_TIME}
        onChange={(value) =>
          editPlan(({ simulation }) => (simulation!.pace = value ? Pace.REAL_TIME : Pace.AS_FAST_AS_POSSIBLE))
        }
      />
      <CheckField
        label="Only the settled shape"
        value={settled}
        onChange={(value) =>
          editPlan(({ simulation }) => {
            simulation!.time = value
              ? create(TimeControlSchema, { goal: TimeControl_Goal.SETTLED_SHAPE, endS: 600 })
              : create(TimeControlSchema, { stepMs: 10, maxStepMs: 2000, endS: 120, settleSkinSpeedMmPerS: 0.01 });
          })
        }
      />
      <CheckField
        label="Preview first"
        value={preview ?? false}
        onChange={(value) => editPlan(({ simulation }) => (simulation!.preview = value))}
      />
      <NumberField
        label="Ends at the latest after"
        unit="s"
        min={0}
        value={time?.endS}
        placeholder="60"
        field="simulation.time.end_s"
        onChange={(value) =>
          editPlan(({ simulation }) => ((simulation!.time ??= create(TimeControlSchema)).endS = value))
        }
      />
      <Complaint field="simulation.time" />
    </Section>
  );
}

function Remarks() {
  return (
    <>
      {remarks.value.map(({ field, description }) => (
        <p class="hint" key={field}>
          {fieldWords(field, plan.value)} {plainWords(description, plan.value)}.
        </p>
      ))}
    </>
  );
}

export function FatPanel() {
  return (
    <>
      {!modelIsCurrent.value && <p class="hint">The model is not built yet: zones show once it is.</p>}
      <ProposalSection />
      <Planes />
      <Injections />
      <DeliverySection />
      <Fat />
      <Ligaments />
      <Time />
      <Remarks />
      <Complaint field="simulation.films" />
    </>
  );
}
