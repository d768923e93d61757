// Two edits of one plan: what is put together, what is told, what of a page is kept.
import { clone } from "@bufbuild/protobuf";
import { PlanSchema, type Plan } from "@wire/plan_pb";
import { PlanSide } from "@wire/plan_service_pb";
import { describe, expect, it } from "vitest";
import { mergeWords } from "../../src/case/change_words";
import { changesOf, mergePlans } from "../../src/case/merge";
import { contentOf, sideOf, titleOf } from "../../src/case/saved_plan";
import { vectorOf } from "../../src/plan/landmarks";
import { newInjection, newPlan, newZone } from "../../src/plan/new_plan";

function base(): Plan {
  const plan = newPlan();
  plan.name = "cheek";
  const spec = plan.simulation!;
  spec.films[0].zones = [newZone("malar_left", "malar_left")];
  spec.injections = [newInjection("malar_left")];
  spec.injections[0].volumeMl = 1;
  spec.injections[0].rateMlPerS = 0.5;
  return plan;
}

function edited(change: (plan: Plan) => void): Plan {
  const plan = clone(PlanSchema, base());
  change(plan);
  return plan;
}

const region = (plan: Plan) => {
  const { geometry } = plan.model!;
  if (geometry.case !== "scanRegion") throw new Error("the plan is of a face");
  return geometry.value;
};

describe("two edits of one plan", () => {
  it("of different fields are both taken", () => {
    const ours = edited((plan) => (plan.simulation!.injections[0].volumeMl = 2));
    const theirs = edited((plan) => {
      plan.simulation!.injections[0].rateMlPerS = 0.2;
      region(plan).landmarksMm = { nasion: vectorOf([1, 2, 3]) };
    });
    const { plan, theirs: told, lost } = mergePlans(base(), ours, theirs);
    expect(lost).toEqual([]);
    expect(plan.simulation!.injections[0]).toMatchObject({ volumeMl: 2, rateMlPerS: 0.2 });
    expect(region(plan).landmarksMm.nasion.z).toBe(3);
    expect(told.map(({ field }) => field).sort()).toEqual([
      "model.scan_region.landmarks_mm",
      "simulation.injections[0].rate_ml_per_s",
    ]);
  });

  it("leave what is equal as it was written here, whatever order it comes back in", () => {
    const [nasion, menton] = [vectorOf([1, 2, 3]), vectorOf([4, 5, 6])];
    const here = edited((plan) => (region(plan).landmarksMm = { nasion, menton }));
    const theirs = clone(PlanSchema, here);
    region(theirs).landmarksMm = { menton, nasion };
    theirs.simulation!.injections[0].volumeMl = 2;
    const { plan } = mergePlans(here, here, theirs);
    expect(Object.keys(region(plan).landmarksMm)).toEqual(["nasion", "menton"]);
    expect(plan.simulation!.injections[0].volumeMl).toBe(2);
  });

  it("of one field leave what was there first, and tell of the other", () => {
    const ours = edited((plan) => (plan.simulation!.injections[0].volumeMl = 3));
    const theirs = edited((plan) => (plan.simulation!.injections[0].volumeMl = 2));
    const merge = mergePlans(base(), ours, theirs);
    expect(merge.plan.simulation!.injections[0].volumeMl).toBe(2);
    expect(merge.lost).toEqual([{ field: "simulation.injections[0].volume_ml", before: 2, after: 3 }]);
    expect(mergeWords(merge, new Date(2026, 0, 2, 9, 5))).toBe(
      "Changed elsewhere at 09:05: Volume of injection 1 (1 mL → 2 mL). " +
        "Yours came later and was not taken: Volume of injection 1 3 mL.",
    );
  });

  it("that are the same are one", () => {
    const same = edited((plan) => (plan.simulation!.injections[0].volumeMl = 2));
    const merge = mergePlans(base(), same, clone(PlanSchema, same));
    expect(merge.lost).toEqual([]);
    expect(changesOf(merge.plan, same)).toEqual([]);
  });

  it("of lists that grew are not mixed element by element", () => {
    const ours = edited((plan) => plan.simulation!.injections.push(newInjection("ours")));
    const theirs = edited((plan) => plan.simulation!.injections.push(newInjection("theirs")));
    const merge = mergePlans(base(), ours, theirs);
    expect(merge.plan.simulation!.injections.map(({ zone }) => zone)).toEqual(["malar_left", "theirs"]);
    expect(merge.lost.map(({ field }) => field)).toEqual(["simulation.injections"]);
  });

  it("say nothing where the others changed nothing", () => {
    const merge = mergePlans(
      base(),
      edited((plan) => (plan.name = "other")),
      base(),
    );
    expect(merge.plan.name).toBe("other");
    expect(mergeWords(merge, new Date())).toBe("");
  });
});

describe("what is kept of a page", () => {
  it("leaves files and the model of the moment here", () => {
    const plan = edited((next) => {
      next.scan = { $typeName: "lipofill.v1.ScanFile", file: "jane-doe.obj", unit: 1, landmarksFile: "" };
      next.simulation!.model = "patients/p/models/m";
    });
    const content = contentOf(plan);
    expect(content.scan).toBeUndefined();
    expect(content.simulation!.model).toBe("");
    expect(plan.scan?.file).toBe("jane-doe.obj");
  });
  it("has a title that the daemon takes, and the side of its zones", () => {
    expect(titleOf(edited((plan) => (plan.name = "  Left cheek, 2nd try!")))).toBe("left-cheek-2nd-try-");
    expect(sideOf(base())).toBe(PlanSide.LEFT_SIDE);
    expect(sideOf(newPlan())).toBe(PlanSide.PLAN_SIDE_UNSPECIFIED);
    const both = edited((plan) => plan.simulation!.films[0].zones.push(newZone("chin", "malar_right")));
    expect(sideOf(both)).toBe(PlanSide.BOTH_SIDES);
  });
});
