// Reports through the gateway, by the real program and the real daemon.
import { createClient } from "@connectrpc/connect";
import { createGrpcWebTransport } from "@connectrpc/connect-node";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { PatientService } from "@wire/patient_service_pb";
import { halfFace, halfFaceLandmarks } from "../system/faces";
import { root, System } from "../system/system";

const system = new System();
let patients: ReturnType<typeof createClient<typeof PatientService>>;

interface Plan {
  model: { scan_region: { landmarks_mm: object; axes: object } };
}

function jawAngle(): Plan {
  const plan = JSON.parse(readFileSync(join(root, "client/examples/plans/jaw_angle.json"), "utf8")) as Plan;
  const of = JSON.parse(readFileSync(halfFaceLandmarks, "utf8")) as {
    landmarks: Record<string, number[]>;
    axes: object;
  };
  const points = Object.entries(of.landmarks).map(([name, [x, y, z]]) => [name, { x, y, z }] as const);
  plan.model.scan_region.landmarks_mm = Object.fromEntries(points);
  return plan;
}

const ask = (body: object | string, headers: Record<string, string> = {}): Promise<Response> =>
  fetch(new URL("/report", system.address), {
    method: "POST",
    headers: { "content-type": "application/json", ...headers },
    body: typeof body === "string" ? body : JSON.stringify(body),
  });

beforeAll(async () => {
  await system.startDaemon();
  await system.startGateway();
  patients = createClient(PatientService, createGrpcWebTransport({ baseUrl: system.address, httpVersion: "1.1" }));
});
afterAll(() => system.stop());

describe("a report", () => {
  it("is offered", async () => {
    const offer = await fetch(new URL("/report", system.address));
    expect([offer.status, offer.headers.get("content-type")]).toEqual([200, "application/json"]);
  });

  it("is refused in words where the order is wrong, and to other sites", async () => {
    const wrong = await ask({ plan: jawAngle(), face: "", paper: "a0" });
    expect(wrong.status).toBe(400);
    expect(await wrong.text()).toBe('paper is "a0", must be one of a4, letter\n');
    expect((await ask("x", { "content-type": "text/plain" })).status).toBe(415);
    expect((await ask({}, { origin: "http://evil.example" })).status).toBe(403);
    expect((await fetch(new URL("/report", system.address), { method: "DELETE" })).status).toBe(405);
  });

  it("has the program's own words where the daemon refuses the plan", async () => {
    const answer = await ask({ plan: jawAngle(), face: "v 0 0 0\n" });
    const last = JSON.parse((await answer.text()).trim().split("\n").at(-1)!) as { error: string };
    expect(last.error).not.toBe("");
    expect((await patients.listPatients({})).patients, "nothing is left on the daemon").toEqual([]);
  });

  it("comes as page, figures and record, and leaves nothing on the daemon", async () => {
    const answer = await ask({ plan: jawAngle(), face: readFileSync(halfFace, "utf8"), pseudonym: "case-7" });
    expect(answer.headers.get("content-type")).toBe("application/x-ndjson");
    const lines = (await answer.text()).trim().split("\n");
    const made = JSON.parse(lines.at(-1)!) as { html?: string; csv?: string; json?: string; error?: string };
    expect(made.error).toBeUndefined();
    expect(made.html).toContain("case-7");
    expect(made.html).toContain("not a medical device");
    expect(made.csv).toContain("masseter");
    expect(JSON.parse(made.json!)).toHaveProperty("volumes.total.inject_ml");
    expect((await patients.listPatients({})).patients).toEqual([]);
  }, 240_000);
});
