// For everybody: on a touch screen, on a narrow one, enlarged, by keyboard alone.
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { wcagProblems } from "../system/axe";
import { halfFace, halfFaceLandmarks } from "../system/faces";
import { picture, root, System } from "../system/system";

const system = new System();
const errors: string[] = [];
const steps = ["Face", "Goal", "Tissue", "Fat", "Run"];
let address = "";

const goTo = (page: Page, step: string) =>
  page.getByRole("navigation", { name: "Steps of the plan" }).getByRole("button", { name: step }).click();

beforeAll(async () => {
  await system.start();
  const page = await system.newPage(errors);
  await page.goto(system.address);
  await page.getByLabel("Upload scan…").setInputFiles(halfFace);
  await page.getByText("9,991 vertices").waitFor();
  await page.getByLabel("From file…").setInputFiles(halfFaceLandmarks);
  await page.getByText("11 set").waitFor();
  await page.getByLabel("Open plan…").setInputFiles(join(root, "client/examples/plans/jaw_angle.json"));
  await goTo(page, "Tissue");
  await page.getByRole("button", { name: "Build the model" }).click();
  await page.getByText("2,480 elements").waitFor({ timeout: 60_000 });
  await goTo(page, "Fat");
  await page.getByLabel("Only the settled shape").check();
  await goTo(page, "Run");
  await page.getByRole("button", { name: "▶ Run" }).click();
  await page.locator(".state-settled, .state-finished").first().waitFor({ timeout: 60_000 });
  await page.locator(".keeping", { hasText: "Saved" }).waitFor();
  address = page.url();
  await page.context().close();
}, 180_000);
afterAll(() => system.stop());

/** Opens the case on another screen. */
async function openOn(width: number, height: number, isTouch: boolean): Promise<Page> {
  const more = { hasTouch: isTouch, isMobile: isTouch, reducedMotion: "reduce" as const };
  const page = await system.newPage(errors, width, height, more);
  await page.goto(address);
  await page.locator(".timeline").waitFor({ timeout: 30_000 });
  return page;
}

/** Controls that are seen and smaller than a finger, "name width x height". */
const smallTargets = (page: Page): Promise<string[]> =>
  page.evaluate(() =>
    [
      ...document.querySelectorAll<HTMLElement>(
        "button, select, input:not([type=file]), a[href], summary, label.button",
      ),
    ]
      // Its label is pressed as well.
      .map((one) => (one.matches("[type=checkbox], [type=radio]") ? (one.closest("label") ?? one) : one))
      .map((one) => ({ one, box: one.getBoundingClientRect() }))
      .filter(({ box }) => box.width > 0 && box.height > 0)
      .filter(({ box }) => box.width < 43.5 || box.height < 43.5)
      .map(
        ({ one, box }) =>
          `${one.textContent || one.getAttribute("aria-label")} ${box.width.toFixed()} x ${box.height.toFixed()}`,
      ),
  );

/** Parts of the page that are wider than their place, or reach over its side. */
const beyond = (page: Page): Promise<string[]> =>
  page.evaluate(() => {
    const parts = "html, .top, .panel-body, .section, .figures, .timeline, .view-tools, .cases, .dashboard";
    const controls = "button, select, input:not([type=file]), a[href], label, p, h3, td, th";
    const wide = [...document.querySelectorAll<HTMLElement>(parts)].filter(
      (one) => one.clientWidth > 0 && one.scrollWidth > one.clientWidth + 1,
    );
    const out = [...document.querySelectorAll<HTMLElement>(controls)].filter((one) => {
      const box = one.getBoundingClientRect();
      const isThere = box.width > 1 && one.closest(".face-labels, .scalar-bar") === null;
      return isThere && (box.left < -1 || box.right > innerWidth + 1);
    });
    return [...wide, ...out].map((one) => `${one.className || one.tagName} ${(one.textContent ?? "").slice(0, 30)}`);
  });

interface Look {
  /** a finger is what points here */
  isTouch: boolean;
  name: string;
}

/** Every page and step, with the tools of the picture, has nothing that keeps somebody out. */
async function lookThrough(page: Page, { isTouch, name }: Look): Promise<void> {
  const look = async (where: string): Promise<void> => {
    expect(await beyond(page), `${where}, ${name}`).toEqual([]);
    if (isTouch) expect(await smallTargets(page), `${where}, ${name}`).toEqual([]);
    expect(await wcagProblems(page), `${where}, ${name}`).toEqual([]);
    await picture(page, `12-${name}-${where.toLowerCase()}`);
  };
  for (const step of steps) {
    await goTo(page, step);
    await page.locator(".steps [aria-current]", { hasText: step }).waitFor();
    await look(step);
  }
  const tools = page.getByRole("button", { name: "View…" });
  if (await tools.isVisible()) {
    await tools.click();
    await page.getByRole("button", { name: "Left profile" }).waitFor();
    await look("View");
    await page.getByRole("button", { name: "Back to the picture" }).click();
  }
  await page.getByRole("link", { name: "Cases" }).click();
  await page.locator(".case").first().waitFor();
  await look("Cases");
  await page.getByRole("link", { name: "Dashboard" }).click();
  await page.locator(".card").first().waitFor();
  await look("Dashboard");
}

describe("the page", () => {
  it.each([
    { width: 1024, height: 768, isTouch: true, name: "tablet" },
    { width: 320, height: 640, isTouch: true, name: "phone" },
    { width: 720, height: 450, isTouch: false, name: "twice-the-size" },
  ])(
    "keeps nobody out on a screen of $width x $height, $name",
    async ({ width, height, isTouch, name }) => {
      const page = await openOn(width, height, isTouch);
      await lookThrough(page, { isTouch, name });
      await page.context().close();
    },
    180_000,
  );

  it("keeps the picture in sight on a phone while the form goes by", async () => {
    const page = await openOn(320, 640, true);
    await goTo(page, "Fat");
    await page.getByLabel(/^Volume of injection 2/).scrollIntoViewIfNeeded();
    const stage = (await page.locator(".stage").boundingBox())!;
    const slider = (await page.getByLabel(/^Volume of injection 2/).boundingBox())!;
    expect(stage.y).toBeGreaterThanOrEqual(0);
    expect(slider.y, "the slider is below the picture").toBeGreaterThanOrEqual(stage.y + stage.height);
    expect(slider.y + slider.height).toBeLessThanOrEqual(640);
    await picture(page, "12-phone-slider");
    await page.context().close();
  });

  it("is worked by keyboard on every step, and shows where it is", async () => {
    const page = await openOn(1440, 900, false);
    for (const [index, step] of steps.entries()) {
      await page.locator("body").press(String(index + 1));
      await page.locator(".steps [aria-current]", { hasText: step }).waitFor();
      const wanted = await page.evaluate(
        () =>
          [
            ...document.querySelectorAll<HTMLElement>(
              ".panel-body button:enabled, .panel-body select, .panel-body input",
            ),
          ].filter((one) => one.tabIndex >= 0 && one.getClientRects().length > 0).length,
      );
      await page.locator(".steps [aria-current]").focus();
      const reached = new Set<string>();
      let unseen = 0;
      for (let tabs = 0; tabs < wanted + 12; ++tabs) {
        await page.keyboard.press("Tab");
        const now = await page.evaluate(() => {
          const one = document.activeElement as HTMLElement;
          if (!one.closest(".panel-body")) return undefined;
          const all = [...document.querySelectorAll("button, select, input")];
          const ring = [one, one.closest("label") ?? one].some((of) => getComputedStyle(of).outlineStyle !== "none");
          return { key: String(all.indexOf(one)), ring };
        });
        if (now === undefined) continue;
        reached.add(now.key);
        if (!now.ring) ++unseen;
      }
      expect(reached.size, step).toBe(wanted);
      expect(unseen, step).toBe(0);
    }
    await page.context().close();
  });

  it("is turned and brought nearer by one press each, without a drag or two fingers", async () => {
    const page = await openOn(1440, 900, false);
    const camera = (): string | null => new URLSearchParams(new URL(page.url()).hash.split("?")[1]).get("camera");
    let before = camera();
    for (const name of ["Nearer", "Farther", "Turn to the left", "Turn to the right"]) {
      await page.getByRole("button", { name, exact: true }).click();
      await expect.poll(camera, { timeout: 10_000 }).not.toBe(before);
      before = camera();
    }
    await page.context().close();
  });

  it("lets letters and digits be turned off, for good, from a list of the keys", async () => {
    const page = await openOn(1440, 900, false);
    const at = (): Promise<string | null> => page.locator(".steps [aria-current]").textContent();
    const opener = page.getByRole("button", { name: "Keys", exact: true });
    await opener.focus();
    await page.keyboard.press("Enter");
    await page.getByRole("dialog", { name: "Keys" }).waitFor();
    expect(await wcagProblems(page)).toEqual([]);
    await picture(page, "12-keys");
    const own = page.getByLabel("Letters and digits work by themselves");
    expect(await own.evaluate((one) => one === document.activeElement), "the dialog has the focus").toBe(true);
    await page.keyboard.press("Space");
    await page.keyboard.press("Escape");
    await page.getByRole("dialog", { name: "Keys" }).waitFor({ state: "detached" });
    expect(await opener.evaluate((one) => one === document.activeElement), "and gives it back").toBe(true);
    const before = await at();
    await page.keyboard.press("1");
    expect(await at()).toBe(before);
    await page.reload();
    await page.locator(".timeline").waitFor({ timeout: 30_000 });
    await page.keyboard.press("1");
    expect(await at()).toBe(before);
    await opener.click();
    await own.check();
    await page.keyboard.press("Escape");
    await page.keyboard.press("1");
    await expect.poll(at).toMatch(/Face$/);
    await page.context().close();
  });

  it("and all went without a mistake in the page", () => expect(errors).toEqual([]));
});
