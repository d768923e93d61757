// Zones of a film, with its walls.
import { create } from "@bufbuild/protobuf";
import { DiscSchema, WallSchema, ZonePairSchema, type Film, type Zone } from "@wire/simulation_pb";
import { readable, zoneNames } from "../plan/anatomy";
import { placedZones } from "../plan/check";
import { freeName, newZone } from "../plan/new_plan";
import { chart, editPlan, plan, region, zones } from "../plan/state";
import { skinPointAt, tool } from "../plan/tools";
import { cssOf, zoneColours } from "../scene/colour_maps";
import { Complaint, NumberField, SelectField, TextField } from "../widgets/fields";
import { EdgeFields } from "./edge_fields";

const shapeWord: Record<string, string> = { region: "by landmarks", painted: "painted", disc: "disc", box: "box" };

/** Sides of the face that have landmarks. */
function sides(): string[] {
  const names = Object.keys(region.value?.landmarksMm ?? {});
  return ["left", "right"].filter((side) => names.includes(`zygion_${side}`) || names.includes(`gonion_${side}`));
}

function addZone(film: number, choice: string): void {
  const taken = zones.value.map(({ zone }) => zone.name);
  editPlan(({ simulation }) => {
    const { zones: into } = simulation!.films[film];
    if (choice === "painted") {
      const zone = newZone(freeName("painted", taken), "");
      zone.shape = chart.value ? { case: "painted", value: chart.value.empty() } : { case: undefined };
      into.push(zone);
    } else if (choice === "disc") {
      const zone = newZone(freeName("disc", taken), "");
      const centre = skinPointAt(chart.value?.position(0.5, 0.5) ?? [0, 0, 0]);
      zone.shape = { case: "disc", value: create(DiscSchema, { centre, radiusMm: 12 }) };
      into.push(zone);
    } else {
      into.push(newZone(freeName(choice.replace(/_(left|right)$/, ""), taken), choice));
    }
  });
  coverWithModel(choice);
  if (choice === "painted")
    tool.value = { kind: "paint", film, zone: plan.value.simulation!.films[film].zones.length - 1, erase: false };
}

/** A model that goes around its zones goes around a new one as well; it is built again then. */
function coverWithModel(choice: string): void {
  const around = region.value?.around;
  if (!/_(left|right)$/.test(choice) || !around || around.regions.includes(choice)) return;
  editPlan(({ model }) => {
    if (model?.geometry.case === "scanRegion") model.geometry.value.around!.regions.push(choice);
  });
}

/** With what names it elsewhere. */
function rename(film: number, index: number, name: string): void {
  editPlan(({ simulation }) => {
    const zone = simulation!.films[film].zones[index];
    for (const injection of simulation!.injections) if (injection.zone === zone.name) injection.zone = name;
    for (const { place } of simulation!.films[film].walls) {
      if (place.case !== "between") continue;
      if (place.value.first === zone.name) place.value.first = name;
      if (place.value.second === zone.name) place.value.second = name;
    }
    zone.name = name;
  });
}

function ZoneRow({ film, index, zone, number }: { film: number; index: number; zone: Zone; number: number }) {
  const at = `simulation.films[${film}].zones[${index}]`;
  const painting =
    tool.value.kind === "paint" && tool.value.film === film && tool.value.zone === index ? tool.value : undefined;
  const placed = placedZones.value.find(({ number: of, name }) => of === number + 1 && name === zone.name);
  return (
    <li class="item">
      <i class="swatch" style={{ background: cssOf(zoneColours[number % zoneColours.length]) }} aria-hidden="true" />
      <span class="grow">
        <b>{readable(zone.name)}</b>{" "}
        <span class="quiet">
          {shapeWord[zone.shape.case ?? ""] ?? "not placed"}
          {placed && `, ${placed.areaCm2.toFixed(1)} cm²`}
        </span>
      </span>
      {zone.shape.case === "painted" && (
        <>
          <button
            type="button"
            class="button small"
            aria-pressed={painting?.erase === false}
            onClick={() => (tool.value = { kind: "paint", film, zone: index, erase: false })}
          >
            Paint
          </button>
          <button
            type="button"
            class="button small"
            aria-pressed={painting?.erase === true}
            onClick={() => (tool.value = { kind: "paint", film, zone: index, erase: true })}
          >
            Erase
          </button>
        </>
      )}
      <button
        type="button"
        class="icon"
        aria-label={`Remove ${readable(zone.name)}`}
        onClick={() => {
          tool.value = { kind: "turn" };
          editPlan(({ simulation }) => {
            simulation!.films[film].zones.splice(index, 1);
            simulation!.injections = simulation!.injections.filter(({ zone: of }) => of !== zone.name);
          });
        }}
      >
        ×
      </button>
      {(zone.shape.case === "painted" || zone.shape.case === "disc") && (
        <TextField
          label="Name"
          value={zone.name}
          field={`${at}.name`}
          onChange={(name) => name !== "" && rename(film, index, name)}
        />
      )}
      {zone.shape.case === "disc" && (
        <NumberField
          label="Radius"
          unit="mm"
          value={zone.shape.value.radiusMm}
          field={`${at}.disc.radius_mm`}
          onChange={(value) =>
            editPlan(({ simulation }) => {
              const { shape } = simulation!.films[film].zones[index];
              if (shape.case === "disc") shape.value.radiusMm = value;
            })
          }
        />
      )}
      <Complaint field={at} />
    </li>
  );
}

function WallRow({ film, index, of }: { film: number; index: number; of: Film }) {
  const wall = of.walls[index];
  const drawn =
    wall.place.case === "path"
      ? `${wall.place.value.points.length} points`
      : wall.place.case === "between"
        ? `between ${readable(wall.place.value.first)} and ${readable(wall.place.value.second)}`
        : "not drawn";
  const drawing = tool.value.kind === "wall" && tool.value.film === film && tool.value.index === index;
  return (
    <li class="item">
      <span class="grow">
        <b>{readable(wall.name)}</b> <span class="quiet">{drawn}</span>
      </span>
      <button
        type="button"
        class="button small"
        aria-pressed={drawing}
        onClick={() => (tool.value = drawing ? { kind: "turn" } : { kind: "wall", film, index })}
      >
        {drawing ? "Done" : "Draw"}
      </button>
      <button
        type="button"
        class="icon"
        aria-label={`Remove ${readable(wall.name)}`}
        onClick={() => editPlan(({ simulation }) => void simulation!.films[film].walls.splice(index, 1))}
      >
        ×
      </button>
      <NumberField
        label="Leakage"
        unit="mL/s/kPa/cm"
        value={wall.leakageMlPerSKpaCm}
        placeholder="sealed"
        field={`simulation.films[${film}].walls[${index}].leakage_ml_per_s_kpa_cm`}
        onChange={(value) =>
          editPlan(({ simulation }) => (simulation!.films[film].walls[index].leakageMlPerSKpaCm = value))
        }
      />
      <Complaint field={`simulation.films[${film}].walls[${index}]`} />
    </li>
  );
}

function addWall(film: number, of: Film): void {
  editPlan(({ simulation }) => {
    const wall = create(WallSchema, {
      name: freeName(
        "wall",
        of.walls.map(({ name }) => name),
      ),
    });
    if (of.zones.length === 2 && of.walls.length === 0) {
      wall.place = {
        case: "between",
        value: create(ZonePairSchema, { first: of.zones[0].name, second: of.zones[1].name }),
      };
    }
    simulation!.films[film].walls.push(wall);
  });
}

export function FilmEditor({ film, of, zonesBefore }: { film: number; of: Film; zonesBefore: number }) {
  const layers = plan.value.model?.layers ?? [];
  const choices = sides().flatMap((side) => zoneNames.map((name) => `${name}_${side}`));
  return (
    <div class="film">
      <SelectField
        label="Fat goes under"
        value={of.belowLayer}
        field={`simulation.films[${film}].below_layer`}
        options={layers.map(({ name }, index) => ({
          value: name,
          label: `${readable(name)}${index === layers.length - 1 ? " (on bone)" : ""}`,
        }))}
        onChange={(value) => editPlan(({ simulation }) => (simulation!.films[film].belowLayer = value))}
      />
      <ul class="items">
        {of.zones.map((zone, index) => (
          <ZoneRow key={index} film={film} index={index} zone={zone} number={zonesBefore + index} />
        ))}
      </ul>
      <SelectField
        label="Add a zone"
        value=""
        field={`simulation.films[${film}].zones`}
        onChange={(value) => value !== "" && addZone(film, value)}
        options={[
          { value: "", label: "Choose…" },
          { value: "painted", label: "Painted by hand" },
          { value: "disc", label: "Disc" },
          ...choices.map((name) => ({ value: name, label: readable(name) })),
        ]}
      />
      <EdgeFields film={film} />
      {of.walls.length > 0 && (
        <ul class="items">
          {of.walls.map((wall, index) => (
            <WallRow key={wall.name} film={film} index={index} of={of} />
          ))}
        </ul>
      )}
      <div class="row">
        <button type="button" class="link" onClick={() => addWall(film, of)}>
          Add a wall
        </button>
        {(plan.value.simulation?.films.length ?? 0) > 1 && (
          <button
            type="button"
            class="link"
            onClick={() => editPlan(({ simulation }) => void simulation!.films.splice(film, 1))}
          >
            Remove this plane
          </button>
        )}
      </div>
      <Complaint field={`simulation.films[${film}].n_xi`} />
      <Complaint field={`simulation.films[${film}].n_eta`} />
    </div>
  );
}
