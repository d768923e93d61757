// Models are built by a long-running operation.
import { anyUnpack } from "@bufbuild/protobuf/wkt";
import { Code, ConnectError } from "@connectrpc/connect";
import { BadRequestSchema } from "@google/rpc/error_details_pb";
import { ModelSchema, type Model, type ModelSpec } from "@wire/model_pb";
import type { Operation } from "@wire/operation_service_pb";
import { newId, operations, patients } from "./client";

export interface BuildProgress {
  fraction: number;
  stage: string;
}

function failure(operation: Operation): ConnectError {
  const error = operation.result.case === "error" ? operation.result.value : undefined;
  const details = (error?.details ?? []).flatMap((any) => {
    const value = anyUnpack(any, BadRequestSchema);
    return value === undefined ? [] : [{ desc: BadRequestSchema, value }];
  });
  return new ConnectError(
    error?.message ?? "the model was not built",
    (error?.code ?? Code.Internal) as Code,
    undefined,
    details,
  );
}

export async function buildModel(
  parent: string,
  spec: ModelSpec,
  progress: (now: BuildProgress) => void,
): Promise<Model> {
  let operation = await patients.buildModel({ requestId: newId(), parent, spec });
  while (!operation.done) {
    progress({ fraction: operation.progress, stage: operation.stage });
    operation = await operations.waitOperation({ name: operation.name, seenProgress: operation.progress });
  }
  const model = operation.result.case === "response" ? anyUnpack(operation.result.value, ModelSchema) : undefined;
  if (model === undefined) throw failure(operation);
  return model;
}
