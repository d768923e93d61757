// The gateway between a client on gRPC-Web and the real daemon.
import { create, type DescMethodUnary } from "@bufbuild/protobuf";
import { Code, ConnectError, createClient } from "@connectrpc/connect";
import { createGrpcWebTransport } from "@connectrpc/connect-node";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { request, type IncomingMessage } from "node:http";
import { createServer, type AddressInfo, type Socket } from "node:net";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { BadRequestSchema } from "@google/rpc/error_details_pb";
import { FrameService, WatchRequestSchema } from "@wire/frame_service_pb";
import { PatientService, ScanFormat, UploadScanRequestSchema, type ScanSchema } from "@wire/patient_service_pb";
import { SimulationService } from "@wire/simulation_service_pb";
import { toBinary } from "@bufbuild/protobuf";
import { startEndless } from "../system/endless";
import { System } from "../system/system";

const system = new System();
let transport: ReturnType<typeof createGrpcWebTransport>;
let patients: ReturnType<typeof createClient<typeof PatientService>>;
let simulations: ReturnType<typeof createClient<typeof SimulationService>>;

beforeAll(async () => {
  await system.startDaemon();
  await system.startGateway();
  transport = createGrpcWebTransport({ baseUrl: system.address, httpVersion: "1.1" });
  patients = createClient(PatientService, transport);
  simulations = createClient(SimulationService, transport);
});
afterAll(() => system.stop());

function fetchText(
  path: string,
  headers: Record<string, string> = {},
): Promise<{ status: number; text: string; headers: IncomingMessage["headers"] }> {
  return new Promise((resolve, reject) => {
    const sent = request(new URL(path, system.address), { headers }, (response) => {
      let text = "";
      response
        .on("data", (chunk: Buffer) => (text += chunk.toString()))
        .on("end", () => resolve({ status: response.statusCode!, text, headers: response.headers }));
    });
    sent.on("error", reject).end();
  });
}

describe("the gateway", () => {
  it("serves the page and the samples, and nothing beside them", async () => {
    const page = await fetchText("/");
    expect(page.text).toContain('<div id="page">');
    expect(page.headers["content-security-policy"]).toContain("default-src 'self'");
    expect((await fetchText("/samples/plans/jaw_angle.json")).text).toContain('"jaw_angle"');
    expect((await fetchText("/samples/../../CHANGELOG.md")).status).toBe(404);
    expect((await fetchText("/nothing")).status).toBe(404);
  });
  it("sends scripts and styles compressed, to be kept: the first load is below 250 kB", async () => {
    const page = await fetchText("/");
    const files = [...page.text.matchAll(/(?:src|href)="\.\/(assets\/[^"]+)"/g)].map(([, path]) => `/${path}`);
    expect(files).toHaveLength(2);
    let total = page.text.length;
    for (const file of files) {
      const { headers } = await fetchText(file, { "accept-encoding": "gzip, br" });
      expect(headers["content-encoding"], file).toBe("br");
      expect(headers["cache-control"], file).toBe("public, max-age=31536000, immutable");
      expect(headers.vary, file).toBe("accept-encoding");
      total += Number(headers["content-length"]);
    }
    expect(total).toBeLessThan(250_000);
    const [script] = files;
    expect((await fetchText(script, { "accept-encoding": "gzip" })).headers["content-encoding"]).toBe("gzip");
    const plain = await fetchText(script, { "accept-encoding": "br;q=0" });
    expect(plain.headers["content-encoding"]).toBeUndefined();
    expect(Number(plain.headers["content-length"])).toBeGreaterThan(400_000);
    expect(plain.text.length).toBeGreaterThan(400_000);
  });
  it("answers to names of this machine only", async () => {
    expect((await fetchText("/", { host: "clinic.example:80" })).status).toBe(421);
  });
  it("passes violations on as the daemon gives them", async () => {
    const error = await patients.createPatient({ patientId: "Not An Id" }).then(
      () => undefined,
      (cause) => ConnectError.from(cause),
    );
    expect(error?.code).toBe(Code.InvalidArgument);
    expect(error?.findDetails(BadRequestSchema)[0].fieldViolations[0].field).toBe("patient_id");
  });
  it("passes request ids there and back", async () => {
    let answered = "";
    await patients.listPatients(
      {},
      { headers: { "x-request-id": "seen-17" }, onHeader: (headers) => (answered = headers.get("x-request-id") ?? "") },
    );
    expect(answered).toBe("seen-17");
  });
  it("takes a scan a chunk a call, as a browser sends it", async () => {
    const { name: parent } = await patients.createPatient({ requestId: "for-a-scan" });
    const bytes = readFileSync(new URL("../../../examples/faces/half_face.obj", import.meta.url));
    const sha256 = createHash("sha256").update(bytes).digest("hex");
    const scan = await patients.createScan({ parent, format: ScanFormat.OBJ, sizeBytes: BigInt(bytes.length), sha256 });
    const asUnary = { ...PatientService.method.uploadScan, methodKind: "unary" } as unknown as DescMethodUnary<
      typeof UploadScanRequestSchema,
      typeof ScanSchema
    >;
    const half = bytes.length >> 1;
    const send = (offset: number, data: Uint8Array) =>
      transport.unary(
        asUnary,
        undefined,
        undefined,
        undefined,
        create(UploadScanRequestSchema, { name: scan.name, offset: BigInt(offset), data }),
      );
    expect((await send(0, bytes.subarray(0, half))).message.receivedBytes).toBe(BigInt(half));
    expect((await send(half, bytes.subarray(half))).message.complete).toBe(true);
    let points = 0n;
    for await (const slice of patients.downloadScanMesh({ name: scan.name }))
      for (const { name, shape } of slice.arrays) if (name === "scan.points") points = shape[0];
    expect(points).toBe(9991n);
  });
});

function residentKb(pid: number): number {
  return Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))![1]);
}

/** Asks for every frame's everything and never reads the answer. */
function stall(simulation: string): ReturnType<typeof request> {
  const message = toBinary(
    WatchRequestSchema,
    create(WatchRequestSchema, { simulation, meshes: ["skin", "film/film", "tissue"], maxRateHz: 1000 }),
  );
  const body = Buffer.concat([Buffer.from([0, 0, 0, 0, message.length]), message]);
  const sent = request(
    new URL("lipofill.v1.FrameService/Watch", system.address),
    { method: "POST", headers: { "content-type": "application/grpc-web+proto", "content-length": body.length } },
    (response) => response.pause(),
  );
  sent.on("error", () => undefined).end(body);
  return sent;
}

describe("a slow browser", () => {
  it("costs its own stream, and no memory that grows", async () => {
    const simulation = await startEndless(transport);
    const stalled = Array.from({ length: 12 }, () => stall(simulation));
    await new Promise((resolve) => setTimeout(resolve, 3000));
    const settled = residentKb(system.gateway!.pid!);
    const before = (await simulations.getSimulation({ name: simulation })).summary!.steps;
    await new Promise((resolve) => setTimeout(resolve, 4000));
    const after = (await simulations.getSimulation({ name: simulation })).summary!.steps;
    expect(after - before, "the solver goes on").toBeGreaterThan(50n);
    expect(residentKb(system.gateway!.pid!) - settled, "kB").toBeLessThan(20_000);
    let frames = 0;
    for await (const { message } of createClient(FrameService, transport).watch({ simulation }))
      if (message.case === "frame" && message.value.last && ++frames === 5) break;
    expect(frames, "others are served").toBe(5);
    stalled.forEach((sent) => sent.destroy());
    await simulations.stopSimulation({ name: simulation });
  });
});

/**
 * What a call through a gateway ends with when its daemon's connection ends so, with the call's
 * first bytes.
 */
async function callLosing(end: (socket: Socket) => void): Promise<ConnectError> {
  const dying = createServer((socket) => socket.on("error", () => undefined).once("data", () => end(socket)));
  await new Promise<void>((resolve) => dying.listen(0, "127.0.0.1", resolve));
  const lost = new System();
  lost.daemonPort = String((dying.address() as AddressInfo).port);
  try {
    await lost.startGateway();
    const through = createClient(PatientService, createGrpcWebTransport({ baseUrl: lost.address, httpVersion: "1.1" }));
    return await through.getPatient({ name: "patients/any" }).then(
      () => expect.fail("nobody answers"),
      (cause) => ConnectError.from(cause),
    );
  } finally {
    await lost.stop();
    dying.close();
  }
}

describe("the daemon's end", () => {
  it("is told in words, and the gateway finds the next one", async () => {
    const { name } = await patients.createPatient({ patientId: "lasting" });
    await system.killDaemon();
    const error = await patients.getPatient({ name }).then(
      () => undefined,
      (cause) => ConnectError.from(cause),
    );
    expect(error?.code).toBe(Code.Unavailable);
    expect(error?.rawMessage).toMatch(/daemon cannot be reached/);
    await system.startDaemon();
    expect((await patients.getPatient({ name })).name).toBe(name);
  });
  it.each([
    ["reset", (socket: Socket) => void socket.resetAndDestroy()],
    ["closed", (socket: Socket) => void socket.destroy()],
    ["ended", (socket: Socket) => void socket.end()],
  ])("is told as such when the connection is %s under a call", async (_, end) => {
    const error = await callLosing(end);
    expect([error.code, error.rawMessage]).toEqual([Code.Unavailable, "the daemon cannot be reached"]);
  });
});
