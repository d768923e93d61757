// Models are built by a long-running operation.
import { ModelSchema, type Model, type ModelSpec } from "@wire/model_pb";
import { newId, patients } from "./client";
import { finish, type Progress } from "./long_work";

export async function buildModel(
  parent: string,
  spec: ModelSpec,
  progress: (now: Progress) => void,
  left?: AbortSignal,
): Promise<Model> {
  return finish(await patients.buildModel({ requestId: newId(), parent, spec }), ModelSchema, progress, left);
}
