// Reports of a plan, made by the program `lipofill` on this machine, as `lipofill report` does.
//
// The page sends the plan and the surfaces that it shows; the program asks the daemon with the
// caller's own credentials, under a patient that it makes and deletes again. Nothing of a request
// becomes the name of a file or a part of a command but words that are checked here.
import { fromJson, toJsonString, type JsonValue } from "@bufbuild/protobuf";
import { PlanSchema, ScanUnit } from "@wire/plan_pb";
import { spawn, type ChildProcess } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import type { IncomingMessage, ServerResponse } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";

/** A plan with painted zones, and two surfaces of 200,000 vertices. */
const mostBytes = 48 << 20;
const [leastMembers, mostMembers] = [50, 10_000];
const tellEveryMs = 2000;
const patienceMs = 5000;

const retentions = ["pooled", "acquired_atrophy", "mixed_indications", "cotton_pad", "centrifuge"];

/** The order of a report, once it is checked. */
interface Order {
  plan: string;
  face: string;
  goal: string;
  options: string[];
}

class Refused extends Error {}

const isIn = (members: number): boolean => members >= leastMembers && members <= mostMembers;

function wordOf(value: unknown, field: string, allowed: string[]): string {
  if (typeof value === "string" && allowed.includes(value)) return value;
  throw new Refused(`${field} is ${JSON.stringify(value)}, must be one of ${allowed.join(", ")}`);
}

function textOf(value: unknown, field: string): string {
  if (value === undefined) return "";
  if (typeof value === "string") return value;
  throw new Refused(`${field} must be a text, the surface as OBJ`);
}

/** The plan by itself: it names no files but the surface beside it. */
function planOf(value: unknown, hasFace: boolean): string {
  let plan;
  try {
    plan = fromJson(PlanSchema, value as JsonValue);
  } catch (error) {
    throw new Refused(`plan is not a plan: ${(error as Error).message}`);
  }
  if (plan.parts.length > 0) throw new Refused("plan has several parts of a face; a report is of one");
  plan.bone = undefined;
  plan.scan = undefined;
  if (plan.simulation) plan.simulation.model = "";
  if (plan.model?.geometry.case === "scanRegion") {
    if (!hasFace) throw new Refused("face is missing: the plan is of a scan");
    plan.model.geometry.value.scan = "";
    plan.model.geometry.value.boneScan = "";
    plan.scan = { $typeName: "lipofill.v1.ScanFile", file: "face.obj", unit: ScanUnit.MILLIMETRE, landmarksFile: "" };
  }
  return toJsonString(PlanSchema, plan, { useProtoFieldName: true });
}

/** @throws Refused that names the field, its value and what it must be */
export function readOrder(body: string): Order {
  let order: Record<string, unknown>;
  try {
    order = JSON.parse(body) as Record<string, unknown>;
  } catch {
    throw new Refused("the body is not JSON");
  }
  if (typeof order !== "object" || order === null) throw new Refused("the body is not a JSON object");
  const [face, goal] = [textOf(order.face, "face"), textOf(order.goal, "goal")];
  const pseudonym = order.pseudonym ?? "";
  if (typeof pseudonym !== "string" || !/^[a-z0-9-]{0,63}$/.test(pseudonym))
    throw new Refused(`pseudonym is ${JSON.stringify(pseudonym)}, must have at most 63 characters of a-z, 0-9 and '-'`);
  const options = [
    ...["--language", wordOf(order.language ?? "en", "language", ["en", "de"])],
    ...["--paper", wordOf(order.paper ?? "a4", "paper", ["a4", "letter"])],
    ...["--retention", wordOf(order.retention ?? "pooled", "retention", retentions)],
    // A word of its own could be taken for an option.
    ...(pseudonym === "" ? [] : [`--pseudonym=${pseudonym}`]),
    ...(goal === "" ? [] : ["--target", "goal.obj", "--in-place"]),
  ];
  const { members } = order;
  if (members === undefined) options.push("--no-forecast");
  else if (typeof members === "number" && Number.isInteger(members) && isIn(members))
    options.push("--members", members.toFixed());
  else
    throw new Refused(
      `members is ${JSON.stringify(members)}, must be a whole number in [${leastMembers}, ${mostMembers}]`,
    );
  return { plan: planOf(order.plan, face !== ""), face, goal, options };
}

async function bodyOf(request: IncomingMessage): Promise<string> {
  const parts: Buffer[] = [];
  let bytes = 0;
  for await (const part of request as AsyncIterable<Buffer>) {
    bytes += part.length;
    if (bytes > mostBytes) throw new Refused(`the request has more than ${mostBytes} bytes`);
    parts.push(part);
  }
  return Buffer.concat(parts).toString();
}

/** The last message of what the program said. */
export function messageIn(said: string): string {
  const at = said.lastIndexOf('{"error"');
  if (at >= 0)
    try {
      return (JSON.parse(said.slice(at)) as { error: { message: string } }).error.message;
    } catch {
      // Then it is what the program said last.
    }
  return said.trim().split("\n").at(-1) ?? "";
}

export class Reports {
  private child: ChildProcess | undefined;
  private busy = false;

  /** @param program  empty: no reports are made */
  constructor(
    private readonly program: string,
    private readonly daemon: string,
    private readonly daemonCa: string,
  ) {}

  /** Whether the request was one for a report; it is answered then. */
  take(request: IncomingMessage, response: ServerResponse): boolean {
    if (this.program === "" || request.url !== "/report") return false;
    if (request.method === "GET") {
      response.writeHead(200, { "content-type": "application/json", "cache-control": "no-store" }).end("{}\n");
    } else if (request.method !== "POST") this.refuse(response, 405, "only GET and POST");
    else if (request.headers["content-type"] !== "application/json")
      this.refuse(response, 415, "only application/json");
    else if (this.busy) this.refuse(response, 503, "another report is being made; try again when it is done");
    else void this.make(request, response);
    return true;
  }

  private refuse(response: ServerResponse, status: number, text: string): void {
    response.writeHead(status, { "content-type": "text/plain; charset=utf-8", connection: "close" }).end(`${text}\n`);
  }

  private async make(request: IncomingMessage, response: ServerResponse): Promise<void> {
    this.busy = true;
    const folder = mkdtempSync(join(tmpdir(), "lipofill-report-"));
    try {
      const order = readOrder(await bodyOf(request));
      writeFileSync(join(folder, "plan.json"), order.plan);
      if (order.face !== "") writeFileSync(join(folder, "face.obj"), order.face);
      if (order.goal !== "") writeFileSync(join(folder, "goal.obj"), order.goal);
      const token = /^Bearer ([\x21-\x7e]+)$/.exec(request.headers.authorization ?? "")?.[1] ?? "";
      if (token !== "") writeFileSync(join(folder, "token"), token, { mode: 0o600 });
      const words = ["report", "plan.json", "--out", "out", "--json", "--server", this.daemon, ...order.options];
      if (token !== "") words.push("--token-file", "token");
      if (this.daemonCa !== "") words.push("--tls-ca", this.daemonCa);
      await this.run(folder, words, response);
    } catch (error) {
      if (!(error instanceof Refused)) console.error(`gateway: a report was not made: ${(error as Error).message}`);
      if (!response.headersSent)
        this.refuse(response, error instanceof Refused ? 400 : 500, (error as Error).message || "no report was made");
      else response.destroy();
    } finally {
      rmSync(folder, { recursive: true, force: true });
      this.busy = false;
    }
  }

  /** Tells what the program says, a line of JSON each, and at last the report. */
  private async run(folder: string, words: string[], response: ServerResponse): Promise<void> {
    response.writeHead(200, { "content-type": "application/x-ndjson", "cache-control": "no-store" });
    const tell = (line: object): void => void response.write(`${JSON.stringify(line)}\n`);
    const child = spawn(this.program, words, { cwd: folder, stdio: ["ignore", "ignore", "pipe"] });
    this.child = child;
    let said = "";
    child.stderr.on("data", (part: Buffer) => (said = (said + part.toString()).slice(-(64 << 10))));
    const timer = setInterval(() => tell({ stage: said.trim().split("\n").at(-1) ?? "" }), tellEveryMs);
    // Whoever goes away needs no report: as with Ctrl-C, nothing is left on the daemon.
    const cancel = (): void => this.end();
    response.once("close", cancel);
    try {
      const code = await new Promise<number | null>((resolve, reject) => {
        child.once("error", reject).once("close", resolve);
      });
      const read = (name: string): Buffer | undefined => {
        const file = join(folder, "out", name);
        return existsSync(file) ? readFileSync(file) : undefined;
      };
      if (code === 0)
        tell({
          html: read("report.html")?.toString() ?? "",
          csv: read("report.csv")?.toString() ?? "",
          json: read("report.json")?.toString() ?? "",
          pdf: read("report.pdf")?.toString("base64"),
        });
      else tell({ error: messageIn(said) || `the program ended with ${code}` });
      response.end();
    } finally {
      clearInterval(timer);
      response.off("close", cancel);
      this.child = undefined;
    }
  }

  /** Ends what is being made. */
  end(): void {
    const { child } = this;
    child?.kill("SIGINT");
    setTimeout(() => child?.exitCode === null && child.kill("SIGKILL"), patienceMs).unref();
  }
}
