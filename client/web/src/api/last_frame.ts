// The newest frame of a simulation with its meshes: a stream is opened for it and left again.
import { ArrayType } from "@wire/frame_service_pb";
import { ArrayAssembler } from "./arrays";
import { frames } from "./client";
import { meshesOf, type Mesh } from "./meshes";
import type { Frame } from "./watch";

export interface LastFrame {
  meshes: Map<string, Mesh>;
  frame: Frame;
}

/**
 * @param fields  "skin.displacement", ...; the meshes are those of the fields
 * @throws ConnectError, Error where nothing comes
 */
export async function lastFrame(simulation: string, fields: string[], left?: AbortSignal): Promise<LastFrame> {
  const assembler = new ArrayAssembler();
  const enough = new AbortController();
  const end = (): void => enough.abort();
  left?.addEventListener("abort", end);
  let meshes: Map<string, Mesh> | undefined;
  const request = { simulation, fields, fieldType: ArrayType.UINT16 };
  try {
    for await (const { message } of frames.watch(request, { signal: enough.signal })) {
      if (message.case === "mesh") {
        message.value.arrays.forEach((array) => assembler.add(array));
        if (message.value.last) meshes = meshesOf(assembler.take());
      } else if (message.case === "frame") {
        const { epoch, sequence, timeS, preview, end: isEnd, last } = message.value;
        message.value.fields.forEach((array) => assembler.add(array));
        if (!last || meshes === undefined) continue;
        return { meshes, frame: { epoch, sequence, timeS, preview, end: isEnd, fields: assembler.take() } };
      }
    }
  } finally {
    left?.removeEventListener("abort", end);
    end();
  }
  throw new Error(`${simulation} showed no frame`);
}
