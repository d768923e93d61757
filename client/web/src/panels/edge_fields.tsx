// How the tissue around a film's zones holds together.
import type { Attachment } from "@wire/simulation_pb";
import { editPlan, plan } from "../plan/state";
import { edgeOf } from "../plan/zone_edge";
import { CheckField, NumberField, SelectField } from "../widgets/fields";

const bonds = [
  { value: "region", label: "Septa by region (assumed figures)" },
  { value: "attachment", label: "Elastic, with figures of your own" },
  { value: "rigid", label: "Bonded at the outline" },
];

export function EdgeFields({ film }: { film: number }) {
  const bond = plan.value.simulation?.films[film]?.edge?.bond;
  const at = `simulation.films[${film}].edge`;
  const change = (edit: (attachment: Attachment) => void) =>
    editPlan(({ simulation }) => {
      const edited = simulation!.films[film].edge?.bond;
      if (edited?.case === "attachment") edit(edited.value);
    });
  return (
    <>
      <SelectField
        label="Around the zones"
        value={bond?.case ?? "region"}
        options={bonds}
        field={at}
        onChange={(value) => editPlan(({ simulation }) => (simulation!.films[film].edge = edgeOf(value)))}
      />
      {bond?.case === "attachment" && (
        <>
          <NumberField
            label="Stiffness"
            unit="kPa/mm"
            min={0}
            value={bond.value.stiffnessKpaPerMm}
            field={`${at}.attachment.stiffness_kpa_per_mm`}
            onChange={(value) => change((attachment) => (attachment.stiffnessKpaPerMm = value))}
          />
          <NumberField
            label="Width"
            unit="mm"
            min={0}
            value={bond.value.widthMm}
            field={`${at}.attachment.width_mm`}
            onChange={(value) => change((attachment) => (attachment.widthMm = value))}
          />
          <CheckField
            label="Fat feathers out there"
            value={bond.value.feathers}
            onChange={(value) => change((attachment) => (attachment.feathers = value))}
          />
        </>
      )}
    </>
  );
}
