// The settled shape of a plan with other volumes: figures, and a frame as those of a run.
import type { MessageInitShape } from "@bufbuild/protobuf";
import { ArrayType } from "@wire/frame_service_pb";
import type { FindShapeRequestSchema, FindShapeResponse, FoundShape } from "@wire/simulation_service_pb";
import { ArrayAssembler } from "./arrays";
import { simulations } from "./client";
import type { Frame } from "./watch";

export type ShapeRequest = MessageInitShape<typeof FindShapeRequestSchema>;

export interface Shape {
  found: FoundShape;
  frame: Frame;
}

/** Puts an answer together. @throws Error for one that lacks figures, or a piece of its frame */
export async function collectShape(stream: AsyncIterable<FindShapeResponse>): Promise<Shape> {
  const assembler = new ArrayAssembler();
  let found: FoundShape | undefined;
  let timeS = 0;
  for await (const { message } of stream) {
    if (message.case === "shape") found = message.value;
    else if (message.case === "frame") {
      message.value.fields.forEach((array) => assembler.add(array));
      timeS = message.value.timeS;
    }
  }
  if (found === undefined) throw new Error("the shape came without its figures");
  const fields = assembler.take();
  return { found, frame: { epoch: 0n, sequence: 0n, timeS, preview: false, end: true, fields } };
}

/** @param face  the mesh that is shown: "scan" or "skin" */
export function findShape(face: string, request: ShapeRequest, signal: AbortSignal): Promise<Shape> {
  const fields = ["displacement", "pressure", "thickness"].map((field) => `${face}.${field}`);
  return collectShape(simulations.findShape({ ...request, fields, fieldType: ArrayType.UINT16 }, { signal }));
}
