// A result looked at with its patient: standard views, before and after, another plan beside it,
// rulers, a section, no forms; and a reload that comes back to the same look.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { wcagProblems } from "../system/axe";
import { halfFace, halfFaceLandmarks } from "../system/faces";
import { PictureReader, type Box } from "../system/pixels";
import { picture, root, System } from "../system/system";

const system = new System();
const errors: string[] = [];
let page: Page;
let reader: PictureReader;

/** The first three seconds of the paper-size patient: two hundred frames to go through. */
function shortPlan(): string {
  const plan = JSON.parse(readFileSync(join(root, "client/examples/plans/jaw_angle.json"), "utf8"));
  plan.simulation.time = { step_ms: 20, end_s: 3 };
  const path = join(system.folder, "short.json");
  writeFileSync(path, JSON.stringify(plan));
  return path;
}

const button = (name: string | RegExp) => page.getByRole("button", { name, exact: typeof name === "string" });
const goTo = (step: string) =>
  page.getByRole("navigation", { name: "Steps of the plan" }).getByRole("button", { name: step }).click();
const soon = { timeout: 30_000, interval: 300 };
const words = (): URLSearchParams => new URLSearchParams(page.url().split("?")[1]);
const camera = (): number[] => (words().get("camera") ?? "").split(",").map(Number);
const isOver = () => page.locator(".state-finished").first().waitFor({ timeout: 80_000 });

async function stage(): Promise<Box> {
  const { x, y, width, height } = (await page.locator(".stage").boundingBox())!;
  return { x: Math.round(x), y: Math.round(y), width: Math.round(width), height: Math.round(height) };
}
/** Where the face is, without what lies over it. */
async function middle(): Promise<Box> {
  const { x, y, width, height } = await stage();
  const share = (of: number, by: number): number => Math.round(of * by);
  return { x: x + share(width, 0.3), y: y + 190, width: share(width, 0.4), height: height - 380 };
}
async function clickAt(x: number, y: number): Promise<void> {
  const box = (await page.locator(".view.after").boundingBox())!;
  await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
}

beforeAll(async () => {
  await system.start();
  page = await system.newPage(errors);
  reader = await PictureReader.open(page);
  await page.goto(system.address);
  await page.getByLabel("Upload scan…").setInputFiles(halfFace);
  await page.getByText("9,991 vertices").waitFor();
  await page.getByLabel("From file…").setInputFiles(halfFaceLandmarks);
  await page.getByLabel("Open plan…").setInputFiles(shortPlan());
});
afterAll(() => system.stop());
afterEach(async ({ task }) => {
  if (task.result?.state === "fail") await picture(page, "failed-look");
});

describe("the face of a run", () => {
  it("comes from its plan", async () => {
    await goTo("Run");
    await button("▶ Run").click();
    await isOver();
  });

  it("is looked at from five standard sides, and as from the other one", async () => {
    expect(words().has("camera"), "the page's own view is not in the address").toBe(false);
    const forwards = new Map<string, number>();
    for (const name of ["Right profile", "Right ¾, oblique", "Front", "Left ¾, oblique", "Left profile"]) {
      await button(name).click();
      await expect.poll(() => camera().length, soon).toBe(9);
      await page.waitForTimeout(700);
      const at = camera();
      forwards.set(name, (180 / Math.PI) * Math.atan2(at[0] - at[3], at[2] - at[5]));
    }
    expect([...forwards.values()].map(Math.round)).toEqual([-90, -45, 0, 45, 90]);
    await button("Left ¾, oblique").click();
    await page.waitForTimeout(700);
    const left = camera();
    await button("Other side").click();
    await page.waitForTimeout(700);
    const right = camera();
    // The synthetic face has its middle at x = 0.
    expect(right[0]).toBeCloseTo(-left[0], 0);
    expect(right.slice(1, 3)).toEqual(left.slice(1, 3));
    await button("Left ¾, oblique").click();
    await page.waitForTimeout(1200);
    await picture(page, "10-oblique");
    expect(await wcagProblems(page)).toEqual([]);
  });

  it("is measured: straight, along the skin, and angles, before and after", async () => {
    await button("Measure").click();
    await button("Distance").click();
    await clickAt(0.45, 0.42);
    await clickAt(0.55, 0.62);
    await button("Along the skin").click();
    await clickAt(0.45, 0.42);
    await clickAt(0.55, 0.62);
    await button("Angle").click();
    for (const [x, y] of [
      [0.45, 0.42],
      [0.55, 0.62],
      [0.42, 0.6],
    ])
      await clickAt(x, y);
    const read = async (ruler: string): Promise<number> =>
      parseFloat((await page.locator(`[data-ruler="${ruler}"] b`).textContent())!);
    await expect.poll(() => page.locator("[data-ruler]").count(), soon).toBe(3);
    const [straight, along, angle] = [await read("distance"), await read("skin"), await read("angle")];
    expect(straight).toBeGreaterThan(15);
    expect(along).toBeGreaterThanOrEqual(straight - 0.05);
    expect(along).toBeLessThan(1.6 * straight);
    expect(angle).toBeGreaterThan(20);
    expect(await page.locator(".face-labels .ruler").count()).toBe(3);
    await page.keyboard.press("Escape");
    await picture(page, "10-rulers");
    expect(await wcagProblems(page)).toEqual([]);
    for (let left = 3; left > 0; --left)
      await button(/^Remove (distance|along|angle)/)
        .first()
        .click();
    expect(await page.locator("[data-ruler]").count()).toBe(0);
    await button("Measure").click();
  });

  it("is cut through its layers, with the fat in them", async () => {
    await button("Section").click();
    const fat = page.locator("[data-fat]").first();
    await fat.waitFor({ timeout: 30_000 });
    const thickest = async (): Promise<number> => Number(await fat.getAttribute("data-fat"));
    const first = await thickest();
    expect(first).toBeGreaterThan(0.5);
    await page.waitForTimeout(1000);
    await picture(page, "10-section");
    await page.getByLabel("Place of the section").fill("0.6");
    await expect.poll(thickest, soon).not.toBe(first);
    expect(await wcagProblems(page)).toEqual([]);
    await button("Close the section").click();
  });
});

describe("before and after", () => {
  it("are parted by a line that is dragged over the face", async () => {
    await page.getByRole("radio", { name: "Slider" }).click();
    const line = page.locator(".divider");
    const { x, width } = await stage();
    const box = (await line.boundingBox())!;
    await page.mouse.move(box.x + box.width / 2, box.y + 200);
    await page.mouse.down();
    await page.mouse.move(x + 0.3 * width, box.y + 400, { steps: 4 });
    await page.mouse.up();
    const at = (await line.boundingBox())!;
    expect((at.x + at.width / 2 - x) / width).toBeCloseTo(0.3, 1);
    expect(Number(await page.getByLabel("Share of the picture before").inputValue())).toBeCloseTo(0.3, 1);
    await page.waitForTimeout(1000);
    await picture(page, "10-line");
  });

  it("are another plan of the patient and this one, turned together", async () => {
    await goTo("Fat");
    const volume = page.getByLabel("Volume", { exact: true }).first();
    await volume.fill("1");
    await volume.press("Tab");
    await goTo("Run");
    await button("▶ Run").click();
    await expect.poll(() => page.locator('[data-figure="Injected"]').textContent(), soon).toMatch(/^2\.50/);
    await isOver();
    await page.getByRole("radio", { name: "Side by side" }).click();
    await page.waitForTimeout(1500);
    const before = await picture(page, "10-before");
    const other = page.getByLabel("Compared with");
    await other.focus();
    await expect.poll(() => other.locator("option").count(), soon).toBe(2);
    await other.selectOption({ index: 1 });
    await expect.poll(() => page.locator(".tag-before").textContent(), soon).toMatch(/mL$/);
    await page.waitForTimeout(1500);
    const { x, y, width, height } = await stage();
    const half: Box = { x, y: y + 150, width: Math.round(width / 2) - 4, height: height - 300 };
    const beside = await picture(page, "10-beside");
    expect(await reader.differ(before, beside, half), "the other result in place of the face").toBeGreaterThan(2000);
    await button("Left profile").click();
    await page.waitForTimeout(1000);
    const turned = await picture(page, "10-beside-turned");
    expect(await reader.differ(beside, turned, half), "both are turned").toBeGreaterThan(5000);
    expect(await wcagProblems(page)).toEqual([]);
    await page.getByRole("radio", { name: "After" }).click();
  });
});

describe("a reload", () => {
  it("comes back to the camera and to the moment", async () => {
    const time = page.getByLabel("Simulated time");
    await time.focus();
    for (let k = 0; k < 12; ++k) await page.locator("body").press("ArrowLeft");
    await expect.poll(() => words().get("at"), soon).not.toBeNull();
    // Between two frames as well: they lie 20 ms apart, or more where the page was slow.
    await time.fill(`${(Number(await time.inputValue()) - 0.01).toFixed(2)}`);
    await page.waitForTimeout(1000);
    const [at, look] = [words().get("at"), words().get("camera")];
    expect(Number(at)).toBeLessThan(3);
    const shown = await page.locator(".timeline output").textContent();
    expect(shown, "the moment in the address is that of the frame").toBe(`${at} s`);
    // The scale of the colours is that of the frames that came: the shape is what is compared.
    await page.getByRole("radio", { name: "Skin" }).click();
    await page.waitForTimeout(700);
    const before = await picture(page, "10-moment");
    await page.reload();
    await page.locator(".state-finished").first().waitFor({ timeout: 30_000 });
    await expect.poll(() => page.locator(".timeline output").textContent(), soon).toBe(shown);
    await page.waitForTimeout(2500);
    expect([words().get("at"), words().get("camera")]).toEqual([at, look]);
    await page.getByRole("radio", { name: "Skin" }).click();
    await page.waitForTimeout(700);
    expect(await reader.differ(before, await picture(page, "10-reloaded"), await middle())).toBeLessThan(200);
    await button("Newest").click();
    await expect.poll(() => words().get("at"), soon).toBeNull();
  });
});

describe("for the patient", () => {
  it("there is the face without forms, on every screen", async () => {
    for (const [width, height] of [
      [1024, 768],
      [1920, 1080],
      [1440, 900],
    ]) {
      await page.setViewportSize({ width, height });
      await page.waitForTimeout(1200);
      await picture(page, `10-run-${width}`);
      await button("Present").click();
      expect(await page.locator(".panel, .figures, .top").filter({ visible: true }).count()).toBe(0);
      expect((await stage()).width).toBe(width);
      await page.waitForTimeout(1200);
      const lit = await picture(page, `10-present-${width}`);
      expect(await wcagProblems(page)).toEqual([]);
      if (width === 1440) {
        await button("Dark").click();
        await page.waitForTimeout(1200);
        const dark = await picture(page, "10-present-dark");
        const corner: Box = { x: 4, y: height - 200, width: 60, height: 60 };
        expect(await reader.differ(dark, lit, corner), "dark around the face").toBeGreaterThan(3000);
        expect(await wcagProblems(page)).toEqual([]);
      }
      await page.keyboard.press("Escape");
      await page.locator(".panel").waitFor();
    }
  });
  it("and all went without a mistake in the page", () => expect(errors).toEqual([]));
});
