// Step 3: which part of the face, of what tissue, in how many elements.
import { signal } from "@preact/signals";
import { TissueLayer_Kind, TissueLayer_Law, TissueLayerSchema, TissuePreset } from "@wire/model_pb";
import { create } from "@bufbuild/protobuf";
import { aroundOf, cornersOf, isCornered, landmarksOf, readable, regionLabels, type Side } from "../plan/anatomy";
import { build } from "../plan/actions";
import { freeName, resolutions, setResolution } from "../plan/new_plan";
import { editPlan, model, modelIsCurrent, plan, region, scan } from "../plan/state";
import { busy } from "../activity";
import { tool } from "../plan/tools";
import { CheckField, Complaint, NumberField, Section, Segmented, SelectField } from "../widgets/fields";
import { BaseFields } from "./base_fields";

const side = signal<Side>("left");
const chosen = signal("jaw_zones");
export const showLayers = signal(false);
export const layerShown = signal<boolean[]>([]);

function chooseRegion(key: string, of: Side): void {
  [chosen.value, side.value] = [key, of];
  editPlan(({ model: spec }) => {
    if (spec?.geometry.case !== "scanRegion") return;
    spec.geometry.value.corners = isCornered(key) ? cornersOf(key, of) : [];
    spec.geometry.value.around = isCornered(key) ? undefined : aroundOf(key, of);
  });
}

function Region() {
  const missing = landmarksOf(chosen.value, side.value).filter((name) => region.value?.landmarksMm[name] === undefined);
  return (
    <Section title="Region">
      <SelectField
        label="Part of the face"
        value={chosen.value}
        options={regionLabels.map(({ key, label }) => ({ value: key, label }))}
        onChange={(key) => chooseRegion(key, side.value)}
      />
      <Segmented
        label="Side"
        value={side.value}
        options={[
          { value: "left", label: "Left" },
          { value: "right", label: "Right" },
        ]}
        onChange={(next) => chooseRegion(chosen.value, next)}
      />
      {missing.length > 0 && <p class="hint">Needs: {missing.map(readable).join("; ")}</p>}
      {region.value?.around ? <Surroundings /> : <Corners />}
      <Complaint field="model.scan_region" />
    </Section>
  );
}

/** What the region goes around, and how much skin it takes beside that. */
function Surroundings() {
  const around = region.value?.around;
  return (
    <>
      <p class="hint">Around {(around?.regions ?? []).map(readable).join("; ")}</p>
      <NumberField
        label="Margin"
        unit="mm"
        step={1}
        min={2}
        placeholder="12"
        field="model.scan_region.around.margin_mm"
        value={around?.marginMm}
        onChange={(value) =>
          editPlan(({ model: spec }) => {
            if (spec?.geometry.case === "scanRegion") spec.geometry.value.around!.marginMm = value;
          })
        }
      />
    </>
  );
}

function Corners() {
  return (
    <div class="row wrap" role="group" aria-label="Correct a corner by clicking">
      <span class="quiet">Correct corner</span>
      {[0, 1, 2, 3].map((index) => (
        <button
          type="button"
          class="button small"
          key={index}
          aria-pressed={tool.value.kind === "corner" && tool.value.index === index}
          onClick={() => (tool.value = { kind: "corner", index })}
        >
          {index + 1}
        </button>
      ))}
    </div>
  );
}

const kinds = [
  { value: TissueLayer_Kind.SKIN, label: "Skin" },
  { value: TissueLayer_Kind.SUBCUTANEOUS, label: "Subcutaneous fat" },
  { value: TissueLayer_Kind.SMAS, label: "SMAS" },
  { value: TissueLayer_Kind.MUSCLE, label: "Muscle" },
];

const laws = [
  { value: TissueLayer_Law.LAW_UNSPECIFIED, label: "As the tissue figures say" },
  { value: TissueLayer_Law.NEO_HOOKEAN, label: "Keeps its volume (neo-Hookean)" },
  { value: TissueLayer_Law.COROTATIONAL, label: "Simple (corotational)" },
];

function Layers() {
  const layers = plan.value.model?.layers ?? [];
  return (
    <Section title="Layers, from the skin inwards">
      <SelectField
        label="Tissue figures"
        value={plan.value.model?.tissuePreset ?? 0}
        field="model.tissue_preset"
        options={[
          { value: TissuePreset.PAPER, label: "Firm muscle" },
          { value: TissuePreset.ELASTOGRAPHY, label: "Muscle at rest, as elastography measures it" },
          { value: 0, label: "As each layer says" },
        ]}
        onChange={(value) => editPlan(({ model: spec }) => (spec!.tissuePreset = Number(value)))}
      />
      {layers.map((layer, index) => (
        <fieldset class="layer" key={index}>
          <legend>
            <i class={`swatch layer-${index}`} aria-hidden="true" />
            {readable(layer.name || (kinds.find(({ value }) => value === layer.kind)?.label ?? "layer"))}
          </legend>
          {layer.thicknessMm?.kind.case !== "samples" && (
            <NumberField
              label="Thickness"
              unit="mm"
              step={0.1}
              min={0.1}
              placeholder="preset"
              field={`model.layers[${index}].thickness_mm`}
              value={layer.thicknessMm?.kind.case === "constant" ? layer.thicknessMm.kind.value : undefined}
              onChange={(value) =>
                editPlan(({ model: spec }) => {
                  spec!.layers[index].thicknessMm =
                    value === undefined
                      ? undefined
                      : { $typeName: "lipofill.v1.ScalarField", kind: { case: "constant", value } };
                })
              }
            />
          )}
          <NumberField
            label="Young's modulus"
            unit="kPa"
            min={0}
            placeholder="preset"
            value={layer.youngsModulusKpa}
            field={`model.layers[${index}].youngs_modulus_kpa`}
            onChange={(value) => editPlan(({ model: spec }) => (spec!.layers[index].youngsModulusKpa = value))}
          />
          <SelectField
            label="Law"
            value={layer.law}
            field={`model.layers[${index}].law`}
            options={laws}
            onChange={(value) => editPlan(({ model: spec }) => (spec!.layers[index].law = Number(value)))}
          />
          {layers.length > 1 && (
            <button
              type="button"
              class="link"
              onClick={() => editPlan(({ model: spec }) => void spec!.layers.splice(index, 1))}
            >
              Remove
            </button>
          )}
          <Complaint field={`model.layers[${index}].name`} />
        </fieldset>
      ))}
      <SelectField
        label="Add a layer"
        value=""
        options={[{ value: "", label: "Choose…" }, ...kinds]}
        onChange={(value) => {
          if (value === "") return;
          editPlan(({ model: spec }) => {
            const kind = Number(value) as TissueLayer_Kind;
            const name = freeName(
              TissueLayer_Kind[kind].toLowerCase(),
              spec!.layers.map((layer) => layer.name),
            );
            const layer = create(TissueLayerSchema, { name, kind });
            const inner = spec!.layers.findIndex((other) => other.kind > kind);
            spec!.layers.splice(inner < 0 ? spec!.layers.length : inner, 0, layer);
          });
        }}
      />
    </Section>
  );
}

function Resolution() {
  const { nXi, nEta } = plan.value.model ?? {};
  const now = resolutions.find((option) => option.nXi === nXi && option.nEta === nEta)?.key ?? "own";
  const options = [
    ...resolutions.map(({ key, label }) => ({ value: key, label })),
    ...(now === "own" ? [{ value: "own", label: `${nXi} × ${nEta} elements` }] : []),
  ];
  return (
    <SelectField
      label="Resolution"
      value={now}
      options={options}
      field="model.n_xi"
      onChange={(key) => {
        const option = resolutions.find((candidate) => candidate.key === key);
        if (option) editPlan((next) => setResolution(next, option));
      }}
    />
  );
}

function Built() {
  const { spec, report } = model.value ?? {};
  if (!spec || !report) return null;
  return (
    <Section title="Model">
      <p class="quiet">
        {report.hexahedra.toLocaleString("en")} elements, {spec.nXi} × {spec.nEta} in the skin,{" "}
        {report.areaCm2.toFixed(0)} cm², {report.tissueVolumeMl.toFixed(0)} mL of tissue
      </p>
      <CheckField label="See the layers" value={showLayers.value} onChange={(value) => (showLayers.value = value)} />
      {showLayers.value &&
        report.layers.map(({ name, meanThicknessMm }, index) => (
          <CheckField
            key={name}
            label={`${readable(name)}, ${meanThicknessMm.toFixed(1)} mm`}
            value={layerShown.value[index] ?? true}
            onChange={(value) =>
              (layerShown.value = report.layers.map((_, k) => (k === index ? value : (layerShown.value[k] ?? true))))
            }
          />
        ))}
      {report.scanRemarks.map((remark) => (
        <p class="hint" key={remark}>
          {remark}
        </p>
      ))}
    </Section>
  );
}

export function TissuePanel() {
  const isScan = plan.value.model?.geometry.case === "scanRegion";
  return (
    <>
      {isScan && <Region />}
      <Layers />
      {isScan && (
        <Section title="Base">
          <BaseFields />
        </Section>
      )}
      <Section title="Elements">
        <Resolution />
        <button
          type="button"
          class="button primary wide"
          disabled={busy.value !== undefined || modelIsCurrent.value || (isScan && !scan.value)}
          onClick={() => void build()}
        >
          {modelIsCurrent.value ? "Model is built" : model.value ? "Build again" : "Build the model"}
        </button>
      </Section>
      <Built />
    </>
  );
}
