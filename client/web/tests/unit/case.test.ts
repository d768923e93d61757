// Whose face it is: addresses, and what of a plan lies on one face only.
import { create } from "@bufbuild/protobuf";
import { SkinPointSchema } from "@wire/geometry_pb";
import { DiscSchema, LigamentSchema } from "@wire/simulation_pb";
import { describe, expect, it } from "vitest";
import type { Mesh } from "../../src/api/meshes";
import { parseAddress, writeAddress } from "../../src/case/address";
import { vectorOf } from "../../src/plan/landmarks";
import { newInjection, newPlan, newZone } from "../../src/plan/new_plan";
import { checkOnFace, hasPlaces, liesOn, medianOff, removePlaces } from "../../src/plan/places";
import type { CameraPose } from "../../src/scene/viewport";
import type { Point } from "../../src/scene/surface_geometry";

describe("an address", () => {
  it("is read as it was written", () => {
    const whole = {
      page: "plan" as const,
      step: "fat" as const,
      patient: "patients/p1",
      plan: "patients/p1/plans/q-1",
      scan: "patients/p1/scans/s-2",
      run: "simulations/w3",
    };
    expect(writeAddress(whole)).toBe("#plan/fat?patient=p1&plan=q-1&scan=s-2&run=w3");
    expect(parseAddress(writeAddress(whole))).toEqual(whole);
    const empty = { page: "plan" as const, step: "face" as const, patient: "", plan: "", scan: "", run: "" };
    expect(parseAddress("")).toEqual(empty);
    expect(parseAddress(writeAddress(empty))).toEqual(empty);
    expect(parseAddress("#dashboard").page).toBe("dashboard");
  });
  it("has the camera and the moment that are looked at", () => {
    const whole = {
      ...parseAddress("#plan/run?patient=p1&run=w3"),
      camera: { position: [1.5, -2, 300], focus: [0, 10, 80.1], up: [0, 1, 0.25] } as CameraPose,
      momentS: 2.5,
    };
    const text = writeAddress(whole);
    expect(text).toBe("#plan/run?patient=p1&run=w3&camera=1.5,-2.0,300.0,0.0,10.0,80.1,0.000,1.000,0.250&at=2.50");
    expect(parseAddress(text)).toEqual(whole);
    for (const bad of ["camera=1,2,3", "camera=1,2,3,4,5,6,7,8,x", "camera=0,0,0,0,0,0,0,1,0", "at=-1", "at=x"])
      expect(parseAddress(`#plan/run?run=w3&${bad}`)).toEqual(parseAddress("#plan/run?run=w3"));
  });
  it("leaves out what is no name", () => {
    expect(parseAddress("#plan/nowhere?patient=../a&scan=b&run=%2F")).toEqual(parseAddress("#plan/face"));
    expect(parseAddress("#plan/fat?scan=b&plan=c")).toEqual(parseAddress("#plan/fat"));
  });
});

const mesh: Mesh = {
  name: "scan",
  points: Float32Array.from(Array.from({ length: 300 }, (_, k) => [k % 10, Math.floor(k / 10), 0]).flat()),
  cells: Uint32Array.of(0, 1, 2),
  corners: 3,
};
const at = (point: Point) => create(SkinPointSchema, { place: { case: "positionMm", value: vectorOf(point) } });

/** A plan with something of everything that lies on one face. */
function planWithPlaces(off = 0) {
  const plan = newPlan();
  const region = plan.model!.geometry;
  if (region.case !== "scanRegion") throw new Error("a new plan is of a face");
  region.value.landmarksMm = { nasion: vectorOf([5, 5, off]), menton: vectorOf([5, 1, off]) };
  const spec = plan.simulation!;
  const painted = newZone("painted", "");
  painted.shape = { case: "painted", value: { $typeName: "lipofill.v1.FieldSamples", nXi: 1, nEta: 1, values: [1] } };
  const disc = newZone("disc", "");
  disc.shape = { case: "disc", value: create(DiscSchema, { centre: at([2, 2, off]), radiusMm: 3 }) };
  spec.films[0].zones = [newZone("masseter", "masseter_left"), painted, disc];
  spec.injections = [newInjection("masseter"), newInjection("painted"), newInjection("disc")];
  spec.injections[0].site = at([3, 3, off]);
  spec.ligaments = [
    create(LigamentSchema, { name: "by_hand", place: { case: "points", value: { points: [at([1, 1, off])] } } }),
    create(LigamentSchema, { name: "named", place: { case: "anatomical", value: "zygomatic_left" } }),
  ];
  return plan;
}

describe("a plan on another face", () => {
  it("is told by where its points lie", () => {
    expect(medianOff([[3, 3, 1]], mesh)).toBeCloseTo(1);
    expect(medianOff([], mesh)).toBeUndefined();
    expect(liesOn(planWithPlaces(0), "face.obj", mesh)).toBe(true);
    expect(liesOn(planWithPlaces(40), "face.obj", mesh)).toBe(false);
  });
  it("is told by the file it names, however near its points are", () => {
    const plan = planWithPlaces(0);
    plan.scan = { $typeName: "lipofill.v1.ScanFile", file: "../faces/other.obj", unit: 1, landmarksFile: "" };
    expect(liesOn(plan, "face.obj", mesh)).toBe(false);
    expect(liesOn(plan, "other.obj", mesh)).toBe(true);
  });
  it("keeps what serves any face, and nothing else", () => {
    const plan = planWithPlaces();
    expect(hasPlaces(plan)).toBe(true);
    removePlaces(plan);
    expect(hasPlaces(plan)).toBe(false);
    const { films, injections, ligaments } = plan.simulation!;
    expect(films[0].zones.map(({ name }) => name)).toEqual(["masseter"]);
    expect(injections.map(({ zone, site }) => [zone, site])).toEqual([["masseter", undefined]]);
    expect(ligaments.map(({ name }) => name)).toEqual(["named"]);
    expect(JSON.stringify(plan)).not.toMatch(/positionMm|nasion/);
  });
  it("brings no landmarks of another face, nor of another unit", () => {
    expect(() => checkOnFace({ nasion: vectorOf([5, 5, 1]) }, mesh)).not.toThrow();
    expect(() => checkOnFace({ nasion: vectorOf([50, 50, 10]) }, mesh)).toThrow(
      /another face, or in another unit.* mm/,
    );
    expect(() => checkOnFace({ nasion: vectorOf([50, 50, 10]) }, undefined)).not.toThrow();
  });
});
