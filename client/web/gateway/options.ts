// The gateway's command line.
import { existsSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { isLoopback, parseHost } from "./hosts";

export interface Options {
  host: string;
  port: number;
  /** names in Host that are served, beside addresses and localhost */
  hostNames: string[];
  /** host:port of the daemon, or unix:/path */
  daemon: string;
  /** PEM file of whoever signed the daemon's certificate; empty: plain text */
  daemonCa: string;
  page: string;
  /** folder with the sample faces and plans; empty: none */
  samples: string;
  portFile: string;
  /** the program that makes reports; empty: none are made */
  reports: string;
}

export class UsageError extends Error {}

export const help = `Serves Lipofill's page and passes its calls on to the daemon.

  gateway [options]

  --listen HOST:PORT     where browsers come; port 0: any free one (default 127.0.0.1:8080)
  --insecure-listen-anywhere
                         allow an address that is not loopback. What passes is not encrypted: put a proxy that encrypts
                         before it, or use deploy/envoy
  --host-name NAME       a name by which browsers know this gateway; can be given several times. Without it they must
                         ask for an address or localhost
  --daemon ADDRESS       of lipofilld, host:port or unix:/path (default: LIPOFILL_SERVER, else 127.0.0.1:50061)
  --daemon-ca FILE       the daemon encrypts; PEM of whoever signed its certificate
  --page DIR             the built page (default: "page" beside this program)
  --samples DIR          sample faces and plans that the page offers (default: client/examples, if it is there)
  --reports PROGRAM      the program lipofill, which makes reports for the page with the caller's credentials, one at a
                         time; "none": no reports (default: the one built beside, if it is there)
  --port-file FILE       writes the port here once it listens
  --help

Credentials are the browser's: the header Authorization is passed on, as is x-request-id.`;

function parseAddress(text: string): { host: string; port: number } {
  const match = /^(?:\[([0-9a-fA-F:]+)\]|([^:]+)):(\d{1,5})$/.exec(text);
  const port = match === null ? NaN : Number(match[3]);
  if (match === null || port > 65535)
    throw new UsageError(`--listen is '${text}', must be HOST:PORT with a port of at most 65535`);
  return { host: match[1] ?? match[2], port };
}

function checkHostName(text: string): string {
  const host = parseHost(text);
  if (host === undefined || host.port !== undefined)
    throw new UsageError(`--host-name is '${text}', must be a name without a port, such as planner.example.org`);
  return host.host;
}

function checkFolder(flag: string, folder: string, file: string): string {
  const path = resolve(folder);
  if (!existsSync(join(path, file))) throw new UsageError(`${flag} is '${folder}', where there is no ${file}`);
  return path;
}

function reportProgram(given: string | undefined, built: string): string {
  if (given === "none") return "";
  if (given === undefined) return existsSync(built) ? built : "";
  const program = resolve(given);
  if (!existsSync(program)) throw new UsageError(`--reports is '${given}', which is not there`);
  return program;
}

/** @throws UsageError naming the option, its value and what it must be */
export function parseOptions(args: string[], environment: NodeJS.ProcessEnv): Options | "help" {
  const text = { type: "string" } as const;
  let values;
  try {
    ({ values } = parseArgs({
      args,
      options: {
        listen: { ...text, default: "127.0.0.1:8080" },
        "insecure-listen-anywhere": { type: "boolean", default: false },
        "host-name": { ...text, multiple: true, default: [] as string[] },
        daemon: { ...text, default: environment.LIPOFILL_SERVER ?? "127.0.0.1:50061" },
        "daemon-ca": { ...text, default: "" },
        page: text,
        samples: text,
        "port-file": { ...text, default: "" },
        reports: text,
        help: { type: "boolean", default: false },
      },
    }));
  } catch (error) {
    throw new UsageError((error as Error).message);
  }
  if (values.help) return "help";
  const { host, port } = parseAddress(values.listen);
  if (!isLoopback(host) && !values["insecure-listen-anywhere"]) {
    throw new UsageError(
      `--listen is '${values.listen}', which others can reach in plain text; see --insecure-listen-anywhere`,
    );
  }
  if (!/^(unix:.+|[^:]+:\d{1,5}|\[.+\]:\d{1,5})$/.test(values.daemon)) {
    throw new UsageError(`--daemon is '${values.daemon}', must be host:port or unix:/path`);
  }
  if (values["daemon-ca"] && !existsSync(values["daemon-ca"])) {
    throw new UsageError(`--daemon-ca is '${values["daemon-ca"]}', which is not there`);
  }
  const beside = dirname(fileURLToPath(import.meta.url));
  const examples = join(beside, "../../client/examples");
  return {
    host,
    port,
    hostNames: values["host-name"].map(checkHostName),
    daemon: values.daemon,
    daemonCa: values["daemon-ca"] && resolve(values["daemon-ca"]),
    page: checkFolder("--page", values.page ?? join(beside, "page"), "index.html"),
    samples:
      values.samples === undefined
        ? existsSync(examples)
          ? examples
          : ""
        : checkFolder("--samples", values.samples, "plans"),
    portFile: values["port-file"],
    reports: reportProgram(values.reports, join(beside, "../release/bin/lipofill")),
  };
}
