import { create } from "@bufbuild/protobuf";
import { ComputingCostSchema, ProbeSchema, SeriesRowSchema } from "@wire/simulation_pb";
import { describe, expect, it } from "vitest";
import { parseSeries, writeSeries } from "../../src/run/series_csv";

const row = create(SeriesRowSchema, {
  step: 7n,
  timeS: 0.1,
  injectedMl: 1 / 3,
  probeThicknessMm: [0.25],
  probePressurePa: [12],
  closedCells: 4,
  cost: { cpuMs: 8.5, fallbacks: 2n },
});
const probes = ["centre", "edge"].map((name) => create(ProbeSchema, { name }));

describe("the series as a table", () => {
  const [head, line] = writeSeries([row], probes).trim().split("\n");
  const names = head.split(",");
  const at = (name: string): string => line.split(",")[names.indexOf(name)];

  it("has every figure of the schema, with those of a probe side by side", () => {
    for (const { name, fieldKind } of SeriesRowSchema.fields)
      if (fieldKind === "scalar" || fieldKind === "enum") expect(names).toContain(name);
    for (const { name } of ComputingCostSchema.fields) expect(names).toContain(name);
    expect(head).toMatch(
      /probe_centre_thickness_mm,probe_centre_pressure_pa,probe_edge_thickness_mm,probe_edge_pressure_pa,wall_ms/,
    );
  });
  it("keeps every digit, and leaves out what a row has not", () => {
    expect(Number(at("injected_ml"))).toBe(1 / 3);
    expect([at("step"), at("cpu_ms"), at("fallbacks"), at("probe_centre_pressure_pa")]).toEqual([
      "7",
      "8.5",
      "2",
      "12",
    ]);
    expect(at("probe_edge_thickness_mm")).toBe("");
  });
  it("is read again", () => {
    const [again] = parseSeries(`${head}\n${line}\n`);
    expect([again.step, again.injectedMl, again.closedCells]).toEqual([7n, 1 / 3, 4]);
  });
});
