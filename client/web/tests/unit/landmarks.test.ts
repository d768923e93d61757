// Landmark files of every kind, as the command line reads them.
import { existsSync, readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { ScanUnit } from "@wire/plan_pb";
import { writeMarkups } from "../../src/plan/landmark_files";
import { understandName } from "../../src/plan/landmark_names";
import { parseLandmarks, pointOf } from "../../src/plan/landmarks";

const read = (text: string, fileName: string, unit = ScanUnit.MILLIMETRE): Record<string, number[]> =>
  Object.fromEntries(
    Object.entries(parseLandmarks(text, unit, fileName).points).map(([name, at]) => [name, pointOf(at)]),
  );

describe("names of landmarks", () => {
  it("are understood in common schemes", () => {
    for (const name of ["gonion_left", "Left Gonion", "go_l", "GoL", "L-go", "go (L)", "gonionLeft", "LGo", "gol"])
      expect(understandName(name), name).toBe("gonion_left");
    const others = {
      zy_r: "zygion_right",
      tr_r: "tragion_right",
      exR: "exocanthion_right",
      "n'": "nasion",
      prn: "pronasale",
    };
    for (const [name, expected] of Object.entries(others)) expect(understandName(name), name).toBe(expected);
    for (const name of ["", "F-1", "tr", "go", "left", "n_left", "sto"])
      expect(understandName(name), name).toBeUndefined();
  });
});

describe("landmark files", () => {
  it("honour the unit they state before that of the scan", () => {
    const text = '{"units": "m", "landmarks": {"nasion": [0.001, 0.002, 0.003]}}';
    expect(read(text, "a.json")).toEqual({ nasion: [1, 2, 3] });
    expect(read(text, "a.json", ScanUnit.CENTIMETRE)).toEqual({ nasion: [1, 2, 3] });
    expect(() => read('{"units": "inch", "landmarks": {}}', "a.json")).toThrow(/inch/);
  });
  it("are tables however they are written", () => {
    const expected = { nasion: [0, 85.5, -1], gonion_left: [62, 9, 30] };
    for (const text of [
      "n,0,85.5,-1\ngo l,62,9,3e1\n",
      'name,x,y,z\r\nn,0,85.5,-1\r\n"go l",62,9,30',
      "\uFEFFlabel;x_mm;y_mm;z_mm\nn;0;85,5;-1\ngo l;62;9;30\n",
      "x (mm)\ty (mm)\tz (mm)\tLandmark\n0\t85.5\t-1\tn\n62\t9\t30\tgo l\n",
      "# made by hand\r0,85.5,-1,n\r\r62,9,30,go l\r",
      "1,0,85.5,-1,n\n2,62,9,30,go l",
      "label,l,p,s,defined\nn,0,85.5,-1,1\ngo l,62,9,30,1\nme,,,,0\n",
      "label,r,a,s\nn,0,-85.5,-1\ngo l,-62,-9,30\n",
    ])
      expect(read(text, "a.csv"), text).toEqual(expected);
    expect(read("name,x_m,y_m,z_m\nn,0.001,0,0\n", "a.csv").nasion[0]).toBeCloseTo(1);
    expect(() => read("n,0,1\n", "a.csv")).toThrow(/line 1/);
    expect(() => read("n,0,1,1\nnasion,0,1,1\n", "a.csv")).toThrow(/twice/);
  });
  it("of 3D Slicer and MeshLab honour frame, unit and what is placed", () => {
    const row = "1,1,2,3,0,0,0,1,1,1,0,nasion,,\n";
    expect(read(`# CoordinateSystem = LPS\n${row}`, "a.fcsv")).toEqual({ nasion: [1, 2, 3] });
    expect(read(`# CoordinateSystem = 0\n${row}`, "a.fcsv")).toEqual({ nasion: [-1, -2, 3] });
    expect(read(row, "a.fcsv")).toEqual({ nasion: [-1, -2, 3] });
    const points = [
      { label: "n", position: [1, 2, 3] },
      { label: "me", positionStatus: "undefined" },
    ];
    const markups = [{ coordinateSystem: "RAS", coordinateUnits: ["cm", "UCUM"], controlPoints: points }];
    expect(read(JSON.stringify({ markups }), "a.mrk.json")).toEqual({ nasion: [-10, -20, 30] });
    const picked =
      "<PickedPoints><point z='3' y=\"2\" x='1' name='go &lt;l&gt;' active='1'/><point active='0' x='0' y='0' z='0' name='me'/></PickedPoints>";
    expect(read(picked, "a.pp")).toEqual({ gonion_left: [1, 2, 3] });
  });
  it("go to 3D Slicer and come back", () => {
    expect(read(writeMarkups([["nasion", [1, 2.5, -3]]]), "a.mrk.json", ScanUnit.METRE)).toEqual({
      nasion: [1, 2.5, -3],
    });
  });
  const cases = new URL("../../../../../shared/data/reader_cases/", import.meta.url);
  it.skipIf(!existsSync(cases))("of other programs are those of the sample face", () => {
    const text = (name: string): string => readFileSync(new URL(name, cases), "utf8");
    const expected = read(text("case%20%233/faces/half_face.landmarks.json"), "a.json");
    for (const name of ["landmarks.mrk.json", "landmarks.fcsv", "landmarks.pp", "landmarks_in_metres.json"]) {
      const points = read(text(name), name);
      expect(Object.keys(points).sort()).toEqual(Object.keys(expected).sort());
      for (const [landmark, at] of Object.entries(points))
        at.forEach((v, c) => expect(v, `${name} ${landmark}`).toBeCloseTo(expected[landmark][c], 6));
    }
  });
});
