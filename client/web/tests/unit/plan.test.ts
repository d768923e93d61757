import { readFileSync, readdirSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { ScanUnit } from "@wire/plan_pb";
import { aroundOf, cornersOf, takeRegionFromZones } from "../../src/plan/anatomy";
import { Chart } from "../../src/plan/chart";
import { locate, parseLandmarks, pointOf, writeLandmarks } from "../../src/plan/landmarks";
import { freeName, newInjection, newPlan, newZone, setResolution } from "../../src/plan/new_plan";
import { fieldWords, plainWords } from "../../src/plan/field_words";
import { parsePlan, writePlan } from "../../src/plan/plan_file";
import { edgeOf } from "../../src/plan/zone_edge";
import { descriptionFor, elsewhere, toPlanFields } from "../../src/plan/violations";

const examples = new URL("../../../examples/", import.meta.url);
const landmarkText = readFileSync(new URL("faces/half_face.landmarks.json", examples), "utf8");

describe("a plan file", () => {
  for (const file of readdirSync(new URL("plans/", examples)).filter(
    (name) => name.endsWith(".json") && !name.includes("landmarks"),
  )) {
    it(`${file} is read, and written as it was`, () => {
      const plan = parsePlan(readFileSync(new URL(`plans/${file}`, examples), "utf8"));
      const again = parsePlan(writePlan(plan, "face.obj", ScanUnit.MILLIMETRE));
      expect(again.model?.layers).toEqual(plan.model?.layers);
      expect(again.simulation).toEqual(plan.simulation);
    });
  }
  it("names what it does not know", () => {
    expect(() => parsePlan('{"name": "x", "volume": 3}')).toThrow(/volume/);
  });
  it("has no names of this daemon's things", () => {
    const plan = newPlan();
    plan.simulation!.model = "patients/a/models/b";
    if (plan.model?.geometry.case === "scanRegion") plan.model.geometry.value.scan = "patients/a/scans/c";
    expect(writePlan(plan, "face.obj", ScanUnit.MILLIMETRE)).not.toMatch(/patients/);
  });
});

describe("landmarks", () => {
  it("are read in the unit of the scan and written in millimetres", () => {
    const unstated = landmarkText.replace('"units": "mm",', "");
    const { points, axes } = parseLandmarks(unstated, ScanUnit.CENTIMETRE);
    expect(points.nasion.y).toBeCloseTo(854.14, 3);
    const again = parseLandmarks(writeLandmarks(points, axes), ScanUnit.MILLIMETRE);
    expect(again.points).toEqual(points);
    expect(again.axes).toEqual(axes);
  });
  it("are refused when they are no points", () => {
    expect(() => parseLandmarks('{"landmarks": {"nasion": [1, "2", 3]}}', ScanUnit.MILLIMETRE)).toThrow(
      /landmarks.nasion/,
    );
    expect(() => parseLandmarks("{}", ScanUnit.MILLIMETRE)).toThrow(/no object/);
  });
  it("place a corner by weights and offsets along the head", () => {
    const { points, axes } = parseLandmarks(landmarkText, ScanUnit.MILLIMETRE);
    const at = locate(cornersOf("jaw", "left")[1], points, axes)!;
    const gonion = pointOf(points.gonion_left);
    expect(at[0]).toBeCloseTo(gonion[0] - 2);
    expect(at[1]).toBeCloseTo(gonion[1] - 17);
    expect(at[2]).toBeCloseTo(gonion[2] - 12);
  });
  it("place the region of a plan without corners around its zones, each once", () => {
    const plan = parsePlan(
      JSON.stringify({
        model: { scan_region: {} },
        simulation: {
          films: [{ zones: [{ region: "chin_left" }, { region: "malar_left" }, { region: "chin_left" }] }],
        },
      }),
    );
    takeRegionFromZones(plan);
    const geometry = plan.model!.geometry;
    expect(geometry.case === "scanRegion" && geometry.value.around?.regions).toEqual(["chin_left", "malar_left"]);
    expect(aroundOf("jaw_zones", "right").regions).toEqual(["masseter_right", "mandibular_angle_right"]);
  });
  it("give no place while one is missing", () => {
    expect(locate(cornersOf("jaw", "right")[0], {}, undefined)).toBeUndefined();
  });
});

describe("the chart", () => {
  const points = Float32Array.from([...Array(12).keys()].flatMap((k) => [k % 4, Math.floor(k / 4), 0]));
  const chart = new Chart({ name: "skin", points, corners: 4, cells: Uint32Array.from([0, 1, 5, 4, 1, 2, 6, 5]) });
  it("knows its rows", () => {
    expect([chart.nXi, chart.nEta]).toEqual([3, 2]);
    expect(chart.position(0.5, 0.25)).toEqual([1.5, 0.5, 0]);
  });
  it("is painted within the brush and nowhere else", () => {
    const samples = chart.empty();
    expect(chart.brush(samples, [1, 1, 0], 1, 1)).toBe(true);
    expect(samples.values.filter((v) => v === 1)).toHaveLength(5);
    expect(chart.brush(samples, [1, 1, 0], 1, 1)).toBe(false);
    chart.brush(samples, [1, 1, 0], 5, 0);
    expect(samples.values.every((v) => v === 0)).toBe(true);
  });
});

describe("a new plan", () => {
  it("leaves the cells of films to the daemon, and all sizes where they follow from the zones", () => {
    const plan = newPlan();
    plan.simulation!.films[0].nXi = 7;
    setResolution(plan, { key: "own", label: "", nXi: 41, nEta: 31 });
    expect([plan.model!.nXi, plan.model!.nEta]).toEqual([41, 31]);
    expect(plan.simulation!.films[0].nXi).toBeUndefined();
    setResolution(plan, { key: "chosen", label: "" });
    expect(plan.model!.nXi).toBeUndefined();
  });
  it("holds the edges of its zones as the user says", () => {
    expect(edgeOf("region")).toBeUndefined();
    expect(edgeOf("rigid")?.bond).toEqual({ case: "rigid", value: true });
    const edge = edgeOf("attachment");
    expect(edge?.bond.case === "attachment" && edge.bond.value.widthMm).toBe(4);
  });
  it("finds free names", () => {
    expect(freeName("deep", ["deep", "deep_2"])).toBe("deep_3");
  });
});

describe("violations", () => {
  it("are shown beside the field they are about", () => {
    const all = toPlanFields(
      [
        { field: "spec.films[0].zones[1].disc.radius_mm", description: "is 0 mm" },
        { field: "spec.model", description: "is missing" },
      ],
      "simulation",
    );
    const plan = newPlan();
    plan.simulation!.films[0].zones = [newZone("masseter", "masseter_left"), newZone("buccal", "buccal_left")];
    const [zone, radius, films] = ["zones[1]", "zones[1].disc.radius_mm", "films"].map((part) =>
      part === "films" ? "simulation.films" : `simulation.films[0].${part}`,
    );
    expect(descriptionFor(zone, all, [zone], plan)).toBe("Radius of zone Buccal is 0 mm");
    expect(descriptionFor("simulation.films[0].zones[10]", all, ["simulation.films[0].zones[10]"], plan)).toBe("");
    // Once, where it is nearest.
    expect(descriptionFor(radius, all, [films, zone, radius], plan)).toBe("Is 0 mm");
    expect(descriptionFor(zone, all, [films, zone, radius], plan)).toBe("");
    expect(descriptionFor(films, all, [films, zone, radius], plan)).toBe("");
    expect(elsewhere(all, [films, zone], plan)).toEqual(["Model is missing"]);
  });
  it("are said in the words of the page", () => {
    const plan = newPlan();
    plan.simulation!.films[0].zones = [newZone("masseter", "masseter_left")];
    plan.simulation!.injections = [newInjection("masseter")];
    expect(fieldWords("simulation.injections[0].volume_ml", plan)).toBe("Volume of injection 1");
    expect(fieldWords("simulation.films[0].zones[0]", plan)).toBe("Zone Masseter");
    expect(fieldWords("model.layers[1].youngs_modulus_kpa", plan)).toBe("Young's modulus of layer Subcutaneous");
    expect(fieldWords("simulation.films[0].n_xi", plan)).toBe("Resolution of plane under Subcutaneous");
    expect(plainWords("lies at (0.25, -1e-3) of the chart, outside zone 'masseter'", plan)).toBe(
      "lies outside zone 'masseter'",
    );
    expect(plainWords("has a film cell at (0.5, 0.25) of the chart where no node of the tissue is free", plan)).toBe(
      "has a film cell where no node of the tissue is free",
    );
    expect(plainWords("needs scan_region.bone_scan; max_total_ml is -2, masseter_left of half_face.obj", plan)).toBe(
      "needs bone scan; max total is -2, masseter, left of half_face.obj",
    );
    expect(plainWords("is less than spec.films[0].zones[0].disc.radius_mm", plan)).toBe(
      "is less than radius of zone Masseter",
    );
  });
});
