// What strangers and bad callers may do to the gateway, and what it costs the others.
import { Code, ConnectError, createClient } from "@connectrpc/connect";
import { createGrpcWebTransport } from "@connectrpc/connect-node";
import { request, type OutgoingHttpHeaders } from "node:http";
import { connect, type Socket } from "node:net";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { FrameService } from "@wire/frame_service_pb";
import { PatientService } from "@wire/patient_service_pb";
import { SimulationService } from "@wire/simulation_service_pb";
import { startEndless } from "../system/endless";
import { System } from "../system/system";

const system = new System();
beforeAll(async () => {
  await system.startDaemon();
  await system.startGateway();
});
afterAll(() => system.stop());

const client = () =>
  createClient(PatientService, createGrpcWebTransport({ baseUrl: system.address, httpVersion: "1.1" }));

function statusOf(headers: OutgoingHttpHeaders, method = "GET", path = "/"): Promise<number> {
  return new Promise((resolve, reject) => {
    request(new URL(path, system.address), { headers, method }, (response) => {
      response.resume().on("end", () => resolve(response.statusCode!));
    })
      .on("error", reject)
      .end();
  });
}

describe("a page of another site", () => {
  it("gets nothing by a name that it made point here", async () => {
    for (const host of ["127.evil.com", "127.0.0.1.evil.com", "127.0.0.1:80@evil.com"])
      expect(await statusOf({ host }), host).toBe(421);
  });
  it("cannot make a browser call the daemon", async () => {
    const path = "/lipofill.v1.PatientService/ListPatients";
    const call = { "content-type": "application/json", origin: "http://evil.com" };
    expect(await statusOf(call, "POST", path)).toBe(403);
    expect(await statusOf({ ...call, origin: system.address.slice(0, -1) }, "POST", path)).not.toBe(403);
  });
});

/** Ends with what the call ended with; undefined for an answer. */
async function failureOf(answer: Promise<unknown>): Promise<ConnectError | undefined> {
  return answer.then(
    () => undefined,
    (cause) => ConnectError.from(cause),
  );
}

describe("a caller with headers as no client of ours sends them", () => {
  it.each([7000, 8000, 8199, 8200, 12_000])("is answered, with a token of %i bytes", async (bytes) => {
    const error = await failureOf(client().listPatients({}, { headers: { authorization: "x".repeat(bytes) } }));
    // This daemon does not ask who calls; what is too long is refused before it is sent there.
    expect(error?.code).toBe(bytes > 8199 ? Code.Unauthenticated : undefined);
  });
  it("is refused beyond 16 KiB of them", async () => {
    expect(await statusOf({ cookie: "x".repeat(17_000) })).toBe(431);
  });
  it("does not end the watches of others", async () => {
    const transport = createGrpcWebTransport({ baseUrl: system.address, httpVersion: "1.1" });
    const simulations = createClient(SimulationService, transport);
    const simulation = await startEndless(transport);
    const watch = createClient(FrameService, transport).watch({ simulation })[Symbol.asyncIterator]();
    const isWatched = async () => (await watch.next()).done === false;
    expect(await isWatched()).toBe(true);
    const bad: Record<string, string>[] = [
      { authorization: "x".repeat(8000) },
      { "x-request-id": "!".repeat(3000), traceparent: "z".repeat(3000), authorization: "y".repeat(7000) },
      { "trace-bin": "not base64 *", "grpc-tags-bin": "%%%" },
    ];
    for (const headers of bad) {
      expect(await failureOf(client().listPatients({}, { headers }))).toBeUndefined();
      // More frames than may have lain in the connection.
      for (let frame = 0; frame < 300; ++frame) expect(await isWatched()).toBe(true);
    }
    await watch.return?.();
    await simulations.stopSimulation({ name: simulation });
  });
});

/** Opens connections that send `text` and no more; ends with how many the gateway has closed. */
async function closedOf(count: number, text: string, withinMs: number): Promise<number> {
  const { hostname, port } = new URL(system.address);
  let closed = 0;
  const sockets: Socket[] = Array.from({ length: count }, () =>
    connect(Number(port), hostname)
      .on("error", () => undefined)
      .on("close", () => ++closed)
      .on("connect", function (this: Socket) {
        this.write(text);
      })
      .resume(),
  );
  const end = Date.now() + withinMs;
  while (closed < count && Date.now() < end) await new Promise((resolve) => setTimeout(resolve, 200));
  sockets.forEach((socket) => socket.destroy());
  return closed;
}

describe("a connection that does not go on", () => {
  it.each([
    ["says nothing", ""],
    ["stops within its headers", "GET / HTTP/1.1\r\nhost: 127.0.0.1\r\nx: "],
  ])("is closed when it %s", async (_, text) => {
    expect(await closedOf(200, text, 25_000)).toBe(200);
  });
  it("leaves room for others meanwhile", async () => {
    const held = closedOf(500, "GET / HTTP/1.1\r\n", 25_000);
    await new Promise((resolve) => setTimeout(resolve, 1000));
    expect(await statusOf({})).toBe(200);
    expect(await held).toBe(500);
  });
});
