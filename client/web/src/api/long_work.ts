// Long-running operations: building a model, making a target, proposing a plan.
import type { DescMessage, MessageShape } from "@bufbuild/protobuf";
import { anyUnpack } from "@bufbuild/protobuf/wkt";
import { Code, ConnectError } from "@connectrpc/connect";
import { BadRequestSchema } from "@google/rpc/error_details_pb";
import type { Operation } from "@wire/operation_service_pb";
import { operations } from "./client";
import { isLost } from "./errors";

export interface Progress {
  /** 0 to 1 */
  fraction: number;
  stage: string;
}

const mostRetries = 20;
const retryMs = 500;

function failure(operation: Operation): ConnectError {
  const error = operation.result.case === "error" ? operation.result.value : undefined;
  const details = (error?.details ?? []).flatMap((any) => {
    const value = anyUnpack(any, BadRequestSchema);
    return value === undefined ? [] : [{ desc: BadRequestSchema, value }];
  });
  return new ConnectError(
    error?.message ?? "the work ended without an answer",
    (error?.code ?? Code.Internal) as Code,
    undefined,
    details,
  );
}

function progressOf({ progress, stage, queuePosition }: Operation): Progress {
  return { fraction: progress, stage: queuePosition > 0 ? `waiting, number ${queuePosition} in line` : stage };
}

/** Where the operation stands, also after a connection that was lost for a while. */
async function waitForChange({ name, progress }: Operation): Promise<Operation> {
  for (let retries = 0; ; ++retries) {
    try {
      return await operations.waitOperation({ name, seenProgress: progress });
    } catch (error) {
      if (!isLost(error) || retries === mostRetries) throw error;
      await new Promise((resolve) => setTimeout(resolve, retryMs));
    }
  }
}

/**
 * Waits for an operation, and cancels it where `left` aborts.
 * @throws ConnectError of the operation, CANCELLED for one that was cancelled
 */
export async function finish<Desc extends DescMessage>(
  operation: Operation,
  response: Desc,
  progress: (now: Progress) => void,
  left?: AbortSignal,
): Promise<MessageShape<Desc>> {
  // One that is over by then has nothing to cancel.
  const cancel = (): void => void operations.cancelOperation({ name: operation.name }).catch(() => undefined);
  left?.addEventListener("abort", cancel, { once: true });
  try {
    while (!operation.done) {
      progress(progressOf(operation));
      operation = await waitForChange(operation);
    }
  } finally {
    left?.removeEventListener("abort", cancel);
  }
  const answer = operation.result.case === "response" ? anyUnpack(operation.result.value, response) : undefined;
  if (answer === undefined) throw failure(operation);
  return answer;
}
