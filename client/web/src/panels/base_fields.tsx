// What lies beneath the tissue.
import { create } from "@bufbuild/protobuf";
import { Support_Kind, SupportSchema } from "@wire/model_pb";
import { editPlan, plan } from "../plan/state";
import { NumberField, SelectField } from "../widgets/fields";

const kinds = [
  { value: Support_Kind.KIND_UNSPECIFIED, label: "As the tissue figures say" },
  { value: Support_Kind.BY_REGION, label: "Bone where the face has bone" },
  { value: Support_Kind.CLAMPED, label: "Bone everywhere" },
  { value: Support_Kind.ELASTIC, label: "Springs everywhere" },
];

export function BaseFields() {
  const base = plan.value.model?.base;
  const kind = base?.kind ?? Support_Kind.KIND_UNSPECIFIED;
  const gives = kind === Support_Kind.BY_REGION || kind === Support_Kind.ELASTIC;
  return (
    <>
      <SelectField
        label="Beneath the tissue"
        value={kind}
        options={kinds}
        field="model.base.kind"
        onChange={(value) =>
          editPlan(({ model }) => {
            const chosen = Number(value) as Support_Kind;
            const stiffnessKpaPerMm = chosen === Support_Kind.ELASTIC ? 1 : undefined;
            model!.base = create(SupportSchema, { kind: chosen, stiffnessKpaPerMm });
          })
        }
      />
      {gives && (
        <NumberField
          label="Stiffness where no bone lies"
          unit="kPa/mm"
          min={0}
          placeholder="1 (assumed)"
          value={base?.stiffnessKpaPerMm}
          field="model.base.stiffness_kpa_per_mm"
          onChange={(value) => editPlan(({ model }) => (model!.base!.stiffnessKpaPerMm = value))}
        />
      )}
    </>
  );
}
