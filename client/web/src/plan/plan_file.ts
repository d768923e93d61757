// A plan as a file: what the page reads and writes, `lipofill run` carries out.
import { clone, fromJsonString, toJsonString } from "@bufbuild/protobuf";
import { PlanSchema, ScanUnit, type Plan } from "@wire/plan_pb";

/** @throws Error that names what is not in the schema */
export function parsePlan(text: string): Plan {
  return fromJsonString(PlanSchema, text);
}

/**
 * The plan by itself: names of things in this daemon stay out, the scan is a file beside the plan,
 * landmarks are inside.
 * @param scanFile  name of the scan's file; empty for a square
 */
export function writePlan(plan: Plan, scanFile: string, unit: ScanUnit): string {
  const out = clone(PlanSchema, plan);
  out.scan = undefined;
  out.bone = undefined;
  if (out.simulation) out.simulation.model = "";
  if (out.model?.geometry.case === "scanRegion") {
    out.model.geometry.value.scan = "";
    out.scan = { $typeName: "lipofill.v1.ScanFile", file: scanFile, unit, landmarksFile: "" };
  }
  return `${toJsonString(PlanSchema, out, { prettySpaces: 1, useProtoFieldName: true })}\n`;
}
