// Every method of the service, passed on to the daemon as it is.
//
// Nothing is kept here: a stream's next message is taken from the daemon when the browser has room
// for it, so a slow browser slows its own stream, by the flow control of both connections, and
// costs no memory. A transport connects again by itself when the daemon comes back.
import type { DescMethod, DescMethodStreaming, DescMethodUnary, DescService, Message } from "@bufbuild/protobuf";
import { Code, ConnectError, type ConnectRouter, type HandlerContext, type Transport } from "@connectrpc/connect";
import { createGrpcTransport } from "@connectrpc/connect-node";
import { readFileSync } from "node:fs";
import { connect as connectSocket } from "node:net";
import { ForecastService } from "@wire/forecast_service_pb";
import { FrameService } from "@wire/frame_service_pb";
import { OperationService } from "@wire/operation_service_pb";
import { PatientService } from "@wire/patient_service_pb";
import { PlanService } from "@wire/plan_service_pb";
import { PlanningService } from "@wire/planning_service_pb";
import { SimulationService } from "@wire/simulation_service_pb";
import type { CallerTransports } from "./callers";

const services = [
  ForecastService,
  FrameService,
  OperationService,
  PatientService,
  PlanService,
  PlanningService,
  SimulationService,
];
const passedBack = ["x-request-id"];

/** "Bearer " and a token of at most 8 KiB, which is all that the daemon looks at. */
const mostCredentials = 8199;
/** What the daemon takes of these; anything else it would replace or leave aside. */
const passedOn: Record<string, RegExp> = {
  "x-request-id": /^[A-Za-z0-9._:-]{1,64}$/,
  traceparent: /^[0-9a-f]{2}(-[0-9a-f]{2,32}){3}$/,
};

/** @param daemon host:port or unix:/path */
export function connectDaemon(daemon: string, caFile: string): Transport {
  const path = daemon.startsWith("unix:") ? daemon.slice("unix:".length) : undefined;
  const scheme = caFile ? "https" : "http";
  return createGrpcTransport({
    baseUrl: path === undefined ? `${scheme}://${daemon}` : "http://localhost",
    nodeOptions: {
      settings: { initialWindowSize: 1 << 20 },
      ...(path === undefined ? {} : { createConnection: () => connectSocket(path) }),
      ...(caFile ? { ca: readFileSync(caFile) } : {}),
    },
    idleConnectionTimeoutMs: 60_000,
  });
}

function credentialsIn(headers: Headers): string {
  const text = headers.get("authorization") ?? "";
  if (text.length <= mostCredentials && /^[\x20-\x7e]*$/.test(text)) return text;
  const why = `the header authorization has ${text.length} characters, must have at most ${mostCredentials}, all ASCII`;
  throw new ConnectError(why, Code.Unauthenticated);
}

/** Only what is known to be well formed goes on: the daemon ends connections for some headers. */
function forward(headers: Headers): Headers {
  const out = new Headers();
  const credentials = credentialsIn(headers);
  if (credentials !== "") out.set("authorization", credentials);
  for (const [name, form] of Object.entries(passedOn)) {
    const value = headers.get(name);
    if (value !== null && form.test(value)) out.set(name, value);
  }
  return out;
}

function answer(from: Headers, context: HandlerContext): void {
  for (const name of passedBack) {
    const value = from.get(name);
    if (value !== null) context.responseHeader.set(name, value);
  }
}

/**
 * What the daemon says stays as it is; that it cannot be reached is said in words for people.
 *
 * A connection that is lost under a call ends it in many ways: refused, reset, or cancelled by the
 * transport though nobody cancelled it. The daemon's own errors carry details, these do not.
 */
function explain(cause: unknown, signal: AbortSignal): ConnectError {
  const error = ConnectError.from(cause);
  const lost = [Code.Unavailable, Code.Aborted, Code.Canceled].includes(error.code);
  const fromNode = error.cause instanceof Error && "code" in error.cause;
  if (signal.aborted || error.details.length > 0 || !(lost || fromNode)) return error;
  return new ConnectError("the daemon cannot be reached", Code.Unavailable, undefined, undefined, cause);
}

async function* only<T>(value: T): AsyncIterable<T> {
  yield value;
}

function makeUnary(callers: CallerTransports, method: DescMethodUnary) {
  return async (request: Message, context: HandlerContext): Promise<Message> => {
    const headers = forward(context.requestHeader);
    const { transport, release } = callers.take(headers.get("authorization") ?? "");
    try {
      const response = await transport.unary(method, context.signal, context.timeoutMs(), headers, request);
      answer(response.header, context);
      return response.message;
    } catch (error) {
      throw explain(error, context.signal);
    } finally {
      release();
    }
  };
}

async function* passStream(
  callers: CallerTransports,
  method: DescMethodStreaming,
  requests: AsyncIterable<Message>,
  context: HandlerContext,
) {
  const headers = forward(context.requestHeader);
  const { transport, release } = callers.take(headers.get("authorization") ?? "");
  try {
    const response = await transport.stream(method, context.signal, context.timeoutMs(), headers, requests);
    answer(response.header, context);
    yield* response.message;
  } catch (error) {
    throw explain(error, context.signal);
  } finally {
    release();
  }
}

function makeHandler(callers: CallerTransports, method: DescMethod) {
  switch (method.methodKind) {
    case "unary":
      return makeUnary(callers, method as DescMethodUnary);
    case "client_streaming":
      return async (requests: AsyncIterable<Message>, context: HandlerContext): Promise<Message> => {
        for await (const response of passStream(callers, method as DescMethodStreaming, requests, context))
          return response;
        throw new ConnectError("the daemon gave no answer", Code.Internal);
      };
    case "server_streaming":
      return (request: Message, context: HandlerContext) =>
        passStream(callers, method as DescMethodStreaming, only(request), context);
    default:
      return (requests: AsyncIterable<Message>, context: HandlerContext) =>
        passStream(callers, method as DescMethodStreaming, requests, context);
  }
}

/** All services of the daemon, as gRPC-Web, Connect and gRPC. */
export function passOn(callers: CallerTransports): (router: ConnectRouter) => void {
  return (router) => {
    for (const service of services as DescService[]) {
      const handlers = Object.fromEntries(
        service.methods.map((method) => [method.localName, makeHandler(callers, method)]),
      );
      router.service(service, handlers as never);
    }
  };
}
