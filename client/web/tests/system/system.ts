// The real daemon, the built gateway and page, and Chromium, for a test.
import { spawn, type ChildProcess } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium, type Browser, type BrowserContextOptions, type Page } from "playwright-core";

export const root = fileURLToPath(new URL("../../../../", import.meta.url));
export const bin = process.env.LIPOFILL_BIN ?? join(root, "build/release/bin");
const built = join(root, "build/web");
export const pictures = join(built, "screenshots");

async function until<T>(what: string, find: () => T | undefined, seconds = 20): Promise<T> {
  const end = Date.now() + seconds * 1000;
  for (;;) {
    const found = find();
    if (found !== undefined) return found;
    if (Date.now() > end) throw new Error(`${what} did not come within ${seconds} s`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

function portIn(file: string): string | undefined {
  const text = existsSync(file) ? readFileSync(file, "utf8").trim() : "";
  return text === "" ? undefined : text;
}

export class System {
  readonly folder = mkdtempSync(join(tmpdir(), "lipofill-web-"));
  daemon: ChildProcess | undefined;
  gateway: ChildProcess | undefined;
  browser: Browser | undefined;
  daemonPort = "0";
  address = "";

  async startDaemon(): Promise<void> {
    const portFile = join(this.folder, "daemon-port");
    rmSync(portFile, { force: true });
    this.daemon = spawn(
      join(bin, "lipofilld"),
      [
        "--listen",
        `127.0.0.1:${this.daemonPort}`,
        "--log-level",
        "warning",
        "--data",
        join(this.folder, "data"),
        "--port-file",
        portFile,
      ],
      { stdio: ["ignore", "ignore", "inherit"] },
    );
    this.daemonPort = await until("the daemon's port", () => portIn(portFile), 30);
  }

  async killDaemon(): Promise<void> {
    const gone = new Promise((resolve) => this.daemon!.once("exit", resolve));
    this.daemon!.kill("SIGKILL");
    await gone;
  }

  async startGateway(port = "0"): Promise<void> {
    const portFile = join(this.folder, "gateway-port");
    rmSync(portFile, { force: true });
    this.gateway = spawn(
      process.execPath,
      [
        join(built, "gateway.mjs"),
        "--listen",
        `127.0.0.1:${port}`,
        "--daemon",
        `127.0.0.1:${this.daemonPort}`,
        "--port-file",
        portFile,
        "--reports",
        existsSync(join(bin, "lipofill")) ? join(bin, "lipofill") : "none",
      ],
      { stdio: ["ignore", "ignore", "inherit"] },
    );
    this.address = `http://127.0.0.1:${await until("the gateway's port", () => portIn(portFile))}/`;
  }

  async startBrowser(): Promise<void> {
    this.browser = await chromium.launch({
      executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
      args: [
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--ignore-gpu-blocklist",
        "--use-gl=angle",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--disable-gpu-rasterization",
        "--enable-precise-memory-info",
        "--js-flags=--expose-gc",
      ],
    });
  }

  /** A page that fails the test on any error it has not caught, and on the console. */
  async newPage(errors: string[], width = 1440, height = 900, more: BrowserContextOptions = {}): Promise<Page> {
    const context = await this.browser!.newContext({ viewport: { width, height }, acceptDownloads: true, ...more });
    const page = await context.newPage();
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("console", (message) => {
      // What a lost connection says in the console is no mistake of the page.
      if (message.type() === "error" && !/net::ERR|Failed to load resource/.test(message.text()))
        errors.push(message.text());
    });
    return page;
  }

  async start(): Promise<void> {
    mkdirSync(pictures, { recursive: true });
    await this.startDaemon();
    await this.startGateway();
    await this.startBrowser();
  }

  async stop(): Promise<void> {
    await this.browser?.close();
    this.gateway?.kill("SIGTERM");
    this.daemon?.kill("SIGTERM");
    if (this.daemon)
      await until(
        "the daemon's end",
        () => (this.daemon!.exitCode ?? this.daemon!.signalCode ?? undefined) as unknown,
        40,
      ).catch(() => this.daemon!.kill("SIGKILL"));
    rmSync(this.folder, { recursive: true, force: true });
  }
}

export async function picture(page: Page, name: string): Promise<Buffer> {
  return page.screenshot({ path: join(pictures, `${name}.png`) });
}
