// Numbers of a forecast as the page shows them.
import { create } from "@bufbuild/protobuf";
import { ForecastSchema } from "@wire/forecast_service_pb";
import { describe, expect, it } from "vitest";
import { figureOf, intervalOf, mapOf, monthWords, mostOf, shareWords, valuesOf } from "../../src/forecast/numbers";

const found = create(ForecastSchema, {
  times: [
    {
      month: 0,
      meanDisplacementMm: [3, 4, 0, 0, 0, 1],
      liftP05Mm: [4, 0.5],
      liftP95Mm: [6, 1.5],
      figures: [
        { name: "max_lift", unit: "mm", p05: 4, p50: 5, p95: 6 },
        { name: "mean_pressure", zone: "masseter", unit: "Pa", p05: 1333.22, p50: 2666.44, p95: 3999.66 },
      ],
    },
    {
      month: 12,
      meanDisplacementMm: [1.5, 2, 0, 0, 0, 0.5],
      liftP05Mm: [1, 0.1],
      liftP95Mm: [4, 1],
      figures: [{ name: "max_lift", unit: "mm", p05: 1, p50: 2.5, p95: 4 }],
    },
  ],
});

describe("maps of the skin", () => {
  it("are the length of the mean, both ends, and how far those are apart", () => {
    expect([...valuesOf(found.times[0], "mean")]).toEqual([5, 1]);
    expect([...valuesOf(found.times[0], "low")]).toEqual([4, 0.5]);
    expect([...valuesOf(found.times[0], "high")]).toEqual([6, 1.5]);
    expect([...valuesOf(found.times[1], "spread")].map((mm) => mm.toFixed(3))).toEqual(["3.000", "0.900"]);
  });

  it("have one scale for all months, and one for mean and ends", () => {
    expect(mapOf(found, "mean").high).toBe(6);
    expect(mapOf(found, "low").high).toBe(6);
    expect(mapOf(found, "spread").high).toBe(3);
  });
});

describe("figures", () => {
  it("are found by name and zone, pressures in mmHg", () => {
    expect(figureOf(found.times[0], "mean_pressure")).toBeUndefined();
    const { low, middle, high } = intervalOf(figureOf(found.times[0], "mean_pressure", "masseter")!);
    expect([low, middle, high].map((mmHg) => mmHg.toFixed(2))).toEqual(["10.00", "20.00", "30.00"]);
  });

  it("stand on a bar that ends at the largest of all months", () => {
    expect(mostOf(found, "max_lift")).toBe(6);
    expect(mostOf(found, "none")).toBeGreaterThan(0);
  });
});

describe("words", () => {
  it("tell months", () => {
    expect([0, 1, 6].map(monthWords)).toEqual(["at once", "after 1 month", "after 6 months"]);
  });

  it("do not say that what hardly happens never does", () => {
    expect([0, 0.001, 0.5, 0.999, 1].map(shareWords)).toEqual([
      "0 of 100",
      "below 1 of 100",
      "50 of 100",
      "above 99 of 100",
      "100 of 100",
    ]);
  });
});
