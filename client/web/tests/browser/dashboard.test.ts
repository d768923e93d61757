// The wall: a dozen simulations without scrolling, what runs first, and an alarm where the daemon
// is away.
import { createClient } from "@connectrpc/connect";
import { createGrpcWebTransport } from "@connectrpc/connect-node";
import { SimulationService } from "@wire/simulation_service_pb";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { wcagProblems } from "../system/axe";
import { startEndless } from "../system/endless";
import { picture, System } from "../system/system";

const system = new System();
const errors: string[] = [];
let page: Page;
const names: string[] = [];
const soon = { timeout: 60_000, interval: 500 };

const states = (): Promise<string[]> => page.locator(".card .state").allTextContents();

/** Cards whose figures reach out of them, and what is out of sight. */
const hidden = (): Promise<string[]> =>
  page.evaluate(() => {
    const inside = (part: Element, of: DOMRect): boolean => {
      const box = part.getBoundingClientRect();
      return (
        box.left >= of.left - 1 && box.right <= of.right + 1 && box.top >= of.top - 1 && box.bottom <= of.bottom + 1
      );
    };
    const screen = new DOMRect(0, 0, innerWidth, innerHeight);
    return [...document.querySelectorAll(".card")].flatMap((card) => {
      const own = card.getBoundingClientRect();
      const parts = [...card.querySelectorAll("h2, .state, .thumb, dd, progress")];
      const name = card.getAttribute("aria-label") ?? "";
      const out = parts.filter((part) => !inside(part, own)).map((part) => `${name}: ${part.tagName}`);
      return inside(card, screen) ? out : [...out, `${name} is out of sight`];
    });
  });

beforeAll(async () => {
  await system.start();
  const transport = createGrpcWebTransport({ baseUrl: system.address, httpVersion: "1.1" });
  const simulations = createClient(SimulationService, transport);
  for (let k = 0; k < 12; ++k) {
    names.push(await startEndless(transport));
    // Three run at most: twelve at work would leave nothing for the browser.
    if (k >= 3) await simulations.stopSimulation({ name: names[k] });
  }
  page = await system.newPage(errors, 1920, 1080);
  await page.goto(`${system.address}#dashboard`);
  await page.locator(".card").nth(11).waitFor();
}, 240_000);
afterAll(() => system.stop());

describe("the dashboard", () => {
  it("has twelve cards in sight, with face, pseudonym and figures, on every wall", async () => {
    await expect.poll(() => page.locator(".card img").count(), soon).toBeGreaterThanOrEqual(9);
    for (const [width, height] of [
      [1440, 900],
      [1920, 1080],
    ]) {
      await page.setViewportSize({ width, height });
      await page.waitForTimeout(1500);
      expect(await hidden(), `${width} x ${height}`).toEqual([]);
      await picture(page, `14-wall-${width}`);
    }
    for (const title of await page.locator(".card h2").allTextContents()) expect(title.trim()).toMatch(/^\S+ \S+/);
    expect(await wcagProblems(page)).toEqual([]);
  });

  it("has what runs first, with its progress and the time that is left, and lets what ended fade", async () => {
    const all = await states();
    expect(all.slice(0, 3).every((state) => /Running|Queued/.test(state))).toBe(true);
    expect(all.slice(3).every((state) => state.startsWith("Stopped"))).toBe(true);
    expect(await page.locator(".card.ended").count()).toBe(9);
    expect(await page.locator(".card progress").count()).toBe(3);
    await expect
      .poll(() => page.locator(".card").first().locator(".card-progress").textContent(), soon)
      .toMatch(/at most \d+ (s|min|h) left, \d+ steps\/s$/);
  });

  it("says that the daemon is away, and when it is back", async () => {
    await page.getByText("The daemon answers").waitFor();
    await system.killDaemon();
    await page.locator(".totals .alarm", { hasText: "Trying again" }).waitFor({ timeout: 30_000 });
    await picture(page, "14-daemon-away");
    expect(await page.locator(".card").count(), "what was known stays").toBe(12);
    await system.startDaemon();
    await page.getByText("The daemon answers").waitFor({ timeout: 60_000 });
  });

  it("opens a run from its card", async () => {
    const runIn = (address: string): string | null => new URLSearchParams(address.split("?")[1] ?? "").get("run");
    const link = page.locator(".card h2 a").first();
    const run = runIn((await link.getAttribute("href"))!);
    expect(names.map((name) => name.split("/").pop())).toContain(run);
    await link.click();
    await expect.poll(() => runIn(page.url()), soon).toBe(run);
    await page.getByRole("navigation", { name: "Steps of the plan" }).waitFor();
  });

  it("and all went without a mistake in the page", () => expect(errors).toEqual([]));
});
