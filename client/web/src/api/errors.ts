// What went wrong, in the daemon's words, and which field it is about.
import { Code, ConnectError } from "@connectrpc/connect";
import { BadRequestSchema } from "@google/rpc/error_details_pb";

export interface Violation {
  /** as in the schema, for example "spec.films[0].n_xi" */
  field: string;
  description: string;
}

export interface Problem {
  message: string;
  violations: Violation[];
  /** the daemon or the gateway is away; trying again may help */
  lost: boolean;
  /** who is calling must say so first */
  unknownCaller: boolean;
}

export function toProblem(cause: unknown): Problem {
  const error = ConnectError.from(cause);
  const violations = error.findDetails(BadRequestSchema).flatMap((detail) => detail.fieldViolations);
  return {
    message: messageOf(error),
    violations: violations.map(({ field, description }) => ({ field, description })),
    lost: isLost(error),
    unknownCaller: error.code === Code.Unauthenticated,
  };
}

function messageOf(error: ConnectError): string {
  if (/failed to fetch|network ?error|load failed/i.test(error.rawMessage)) return "The gateway cannot be reached.";
  return error.rawMessage.length === 0 ? `The call failed (${Code[error.code]}).` : error.rawMessage;
}

/** Whether the connection is to blame, not the request. */
export function isLost(cause: unknown): boolean {
  const error = ConnectError.from(cause);
  return (
    error.code === Code.Unavailable ||
    (error.code === Code.Unknown && /fetch|network|stream|aborted/i.test(error.rawMessage)) ||
    (error.code === Code.Internal && /missing trailer|premature|protocol error/i.test(error.rawMessage))
  );
}
