// The edge of a film's zones, as a plan has it.
import { create } from "@bufbuild/protobuf";
import { AttachmentSchema, ZoneEdge_Outline, ZoneEdgeSchema, type ZoneEdge } from "@wire/simulation_pb";

/** An edge of this kind; figures to begin with are those of firm septa. */
export function edgeOf(bond: string): ZoneEdge | undefined {
  if (bond === "rigid")
    return create(ZoneEdgeSchema, { outline: ZoneEdge_Outline.CURVE, bond: { case: "rigid", value: true } });
  if (bond !== "attachment") return undefined;
  const value = create(AttachmentSchema, { stiffnessKpaPerMm: 25, widthMm: 4 });
  return create(ZoneEdgeSchema, { outline: ZoneEdge_Outline.CURVE, bond: { case: "attachment", value } });
}
