// A long stream: through the daemon's sudden end, and for a minute with memory that stays where it
// is.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { CDPSession, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { picture, root, System } from "../system/system";

const system = new System();
const errors: string[] = [];
let page: Page;

/**
 * The paper-size patient, injected slowly and watched in real time for as long as the test takes.
 */
function longPlan(): string {
  const plan = JSON.parse(readFileSync(join(root, "client/examples/plans/jaw_angle.json"), "utf8"));
  plan.simulation.pace = "REAL_TIME";
  plan.simulation.time = { step_ms: 10, end_s: 600, settle_skin_speed_mm_per_s: 0 };
  plan.simulation.injections = [{ zone: "masseter", volume_ml: 4.5, rate_ml_per_s: 0.05 }];
  const path = join(system.folder, "long.json");
  writeFileSync(path, JSON.stringify(plan));
  return path;
}

beforeAll(async () => {
  await system.start();
  page = await system.newPage(errors);
  await page.goto(system.address);
  await page.getByLabel("Upload scan…").setInputFiles(join(root, "client/examples/faces/half_face.obj"));
  await page.getByText("9,991 vertices").waitFor();
  await page.getByLabel("From file…").setInputFiles(join(root, "client/examples/faces/half_face.landmarks.json"));
  await page.getByLabel("Open plan…").setInputFiles(longPlan());
  await page.keyboard.press("5");
  await page.getByRole("button", { name: "▶ Run" }).click();
  await page.locator(".state-running").waitFor({ timeout: 60_000 });
});
afterAll(() => system.stop());
afterEach(async ({ task }) => {
  if (task.result?.state === "fail") await picture(page, "failed-streaming");
});

const shownTime = (): Promise<number> =>
  page.evaluate(() => parseFloat(document.querySelector(".timeline output")?.textContent ?? "0"));
const pictures = (): Promise<number> =>
  page.evaluate(() => Number(document.querySelector<HTMLElement>(".stage")?.dataset.pictures ?? 0));
const laterThan = (time: number): Promise<unknown> =>
  page.waitForFunction(
    (least) => parseFloat(document.querySelector(".timeline output")?.textContent ?? "0") > least,
    time,
    { timeout: 40_000 },
  );

describe("the dashboard", () => {
  it("shows a run as it goes on", async () => {
    const wall = await system.newPage(errors, 1920, 1080);
    await wall.goto(`${system.address}#dashboard`);
    const card = wall.getByRole("article", { name: "jaw-angle" });
    await card.getByText("Running").waitFor();
    await wall.waitForFunction(() => /[1-9]\d* steps\/s/.test(document.querySelector("article")?.textContent ?? ""));
    expect(await card.textContent()).toMatch(/Volume[\d.]+ \/ 4\.5 mL.*at most .* left/);
    const face = card.getByAltText("The face as it is now");
    const first = await face.getAttribute("src", { timeout: 20_000 });
    await wall.waitForFunction(
      (before) => document.querySelector("article img")?.getAttribute("src") !== before,
      first,
      { timeout: 20_000 },
    );
    await picture(wall, "6-wall");
    await wall.context().close();
  });
});

describe("the daemon's sudden end", () => {
  it("is survived without a reload", async () => {
    await laterThan(1.5);
    await page.evaluate("window.samePage = true");
    await system.killDaemon();
    const stopped = await shownTime();
    await page.getByText("Connection lost").waitFor();
    await picture(page, "7-lost");
    await system.startDaemon();
    await laterThan(stopped + 1);
    await page.getByText("Connection lost").waitFor({ state: "detached" });
    expect(await page.evaluate("window.samePage"), "the same page").toBe(true);
    expect(await page.locator(".state-running").count()).toBe(1);
  });
  it("and so is the gateway's", async () => {
    const port = new URL(system.address).port;
    system.gateway!.kill("SIGKILL");
    await page.getByText("Connection lost").waitFor();
    const stopped = await shownTime();
    await system.startGateway(port);
    await laterThan(stopped + 1);
  });
});

/**
 * What drawing took of the processor, in the page and in the process that stands in for a graphics
 * card, seconds.
 */
async function cpuOf(browser: CDPSession): Promise<number> {
  const { processInfo } = await browser.send("SystemInfo.getProcessInfo");
  return processInfo
    .filter(({ type }) => type === "renderer" || type === "GPU")
    .reduce((sum, { cpuTime }) => sum + cpuTime, 0);
}

/** Of the process that holds the page: what it has for itself, kB. */
async function memoryOf(browser: CDPSession): Promise<number> {
  const { processInfo } = await browser.send("SystemInfo.getProcessInfo");
  const of = processInfo
    .filter(({ type }) => type === "renderer")
    .map(({ id }) => Number(/RssAnon:\s+(\d+)/.exec(readFileSync(`/proc/${id}/status`, "utf8"))?.[1] ?? 0));
  return Math.max(...of);
}

describe("a minute of streaming", () => {
  it("keeps its memory, and shows what comes", async () => {
    const browser = await system.browser!.newBrowserCDPSession();
    const [shownBefore, cpuBefore, began] = [await pictures(), await cpuOf(browser), Date.now()];
    const kilobytes: number[] = [];
    while (Date.now() - began < 60_000) {
      await page.waitForTimeout(2000);
      kilobytes.push(await memoryOf(browser));
    }
    const shown = (await pictures()) - shownBefore;
    const rate = (1000 * shown) / (Date.now() - began);
    const cpuMs = (1000 * ((await cpuOf(browser)) - cpuBefore)) / shown;
    const third = Math.floor(kilobytes.length / 3);
    const [early, late] = [kilobytes.slice(third, 2 * third), kilobytes.slice(2 * third)].map(
      (part) => Math.max(...part) / 1024,
    );
    console.log(
      `streaming: ${rate.toFixed(1)} pictures a second of the paper-size patient, ${cpuMs.toFixed(0)} ms of processor each without a graphics card; page ${early.toFixed(0)} MB, then ${late.toFixed(0)} MB`,
    );
    await picture(page, "8-streaming");
    // The ring of frames goes up and down by half its 96 MB, the collector by as much.
    expect(late - early, "MB more in the last third than in the one before").toBeLessThan(130);
    expect(rate).toBeGreaterThan(1);
    expect(errors).toEqual([]);
  }, 120_000);
});
