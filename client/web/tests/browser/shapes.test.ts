// Volumes under sliders: the skin follows them, and letting go changes the plan; then a run that
// has settled takes more fat.
import { join } from "node:path";
import type { Locator, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { wcagProblems } from "../system/axe";
import { settledPlan } from "../system/plans";
import { PictureReader, type Box } from "../system/pixels";
import { picture, root, System } from "../system/system";

const system = new System();
const errors: string[] = [];
let page: Page;
let reader: PictureReader;

beforeAll(async () => {
  await system.start();
  page = await system.newPage(errors);
  reader = await PictureReader.open(page);
  await page.goto(system.address);
  await page.getByLabel("Upload scan…").setInputFiles(join(root, "client/examples/faces/half_face.obj"));
  await page.getByText("9,991 vertices").waitFor();
  await page.getByLabel("From file…").setInputFiles(join(root, "client/examples/faces/half_face.landmarks.json"));
  await page.getByLabel("Open plan…").setInputFiles(settledPlan(system.folder));
  await page.keyboard.press("3");
  await page.getByRole("button", { name: "Build the model" }).click();
  await page.getByText("2,480 elements").waitFor({ timeout: 60_000 });
  await page.keyboard.press("4");
});
afterAll(() => system.stop());
afterEach(async ({ task }) => {
  if (task.result?.state === "fail") await picture(page, "failed-shapes");
});

const readout = (): Locator => page.getByRole("region", { name: "Shape of these volumes" });
const shapeFigure = async (label: string): Promise<number> =>
  parseFloat((await page.locator(`[data-shape-figure="${label}"]`).textContent())!);
const figure = async (label: string): Promise<number> =>
  parseFloat((await page.locator(`[data-figure="${label}"]`).textContent())!);
const pictures = (): Promise<number> =>
  page.evaluate(() => Number(document.querySelector<HTMLElement>(".stage")?.dataset.pictures ?? 0));
const soon = { timeout: 30_000, interval: 300 };

/** Where the skin moves, without what lies over it. */
async function cheek(): Promise<Box> {
  const box = (await page.locator(".stage").boundingBox())!;
  return {
    x: Math.round(box.x + box.width * 0.3),
    y: Math.round(box.y + 130),
    width: Math.round(box.width * 0.42),
    height: Math.round(box.height - 260),
  };
}

/** Takes the thumb of a slider, which is at a share of its length, and gives it back by a move. */
async function takeThumb(slider: Locator, share: number): Promise<(to: number) => Promise<void>> {
  await slider.scrollIntoViewIfNeeded();
  const { x, y, width, height } = (await slider.boundingBox())!;
  // The middle of the thumb goes along the track less the width of the thumb.
  const at = (of: number): number => x + 8 + of * (width - 16);
  await page.mouse.move(at(share), y + height / 2);
  await page.mouse.down();
  return (to) => page.mouse.move(at(to), y + height / 2);
}

describe("the volume of an injection", () => {
  const slider = () => page.getByRole("slider", { name: /^Volume of injection 1/ });
  it("is dragged, and the skin goes with it", async () => {
    const before = await picture(page, "9-before");
    expect(await slider().inputValue()).toBe("3");
    const moveTo = await takeThumb(slider(), 0.6);
    await moveTo(0.8);
    await readout().waitFor({ timeout: 30_000 });
    await expect.poll(() => shapeFigure("Volume"), soon).toBeGreaterThan(5);
    const [low, lift] = [await shapeFigure("Volume"), await shapeFigure("Skin rises")];
    expect(await page.getByLabel("Volume", { exact: true }).first().inputValue(), "beside it").toBe("4");

    const [shownBefore, began] = [await pictures(), performance.now()];
    for (let step = 0; performance.now() - began < 6000; ++step) {
      await moveTo(0.55 + 0.3 * Math.sin(step / 12));
      await page.waitForTimeout(12);
    }
    const rate = (1000 * ((await pictures()) - shownBefore)) / (performance.now() - began);
    console.log(`dragging: ${rate.toFixed(1)} pictures a second of the paper-size patient, without a graphics card`);

    await moveTo(0.9);
    await expect.poll(() => shapeFigure("Volume"), soon).toBeGreaterThan(low + 0.3);
    await expect.poll(() => shapeFigure("Skin rises"), soon).toBeGreaterThan(lift);
    const dragged = await picture(page, "9-dragged");
    expect(await reader.differ(before, dragged, await cheek()), "the cheek moves").toBeGreaterThan(5000);
    expect(await reader.ofHue(dragged, await cheek(), [36, 98, 164]), "blue where it moved").toBeGreaterThan(1500);
    expect(await readout().getByRole("status").textContent()).toBe("Finding the settled shape…");
  });

  it("is the plan's once it is let go, and the shape stays", async () => {
    await page.mouse.up();
    await page.getByText("Settled shape, not yet run").waitFor({ timeout: 30_000 });
    const volume = Number(await slider().inputValue());
    expect(volume).toBeGreaterThan(4.2);
    expect(Number(await page.getByLabel("Volume", { exact: true }).first().inputValue())).toBe(volume);
    expect(await shapeFigure("Volume")).toBeCloseTo(volume + 1.5, 1);
    expect(await readout().textContent()).toMatch(/Highest pressure.*mmHg/);
    await page.waitForTimeout(1500);
    await picture(page, "9-let-go");
    await page.getByRole("radio", { name: "Pressure" }).click();
    await page.waitForTimeout(1500);
    await picture(page, "9-pressure");
    expect(await wcagProblems(page)).toEqual([]);
    await page.getByRole("radio", { name: "Displacement" }).click();
  });

  it("is moved by the keyboard", async () => {
    const before = Number(await slider().inputValue());
    await slider().focus();
    await page.keyboard.press("ArrowLeft");
    await expect.poll(() => slider().inputValue().then(Number), soon).toBeCloseTo(before - 0.05, 5);
    await expect.poll(() => shapeFigure("Volume"), soon).toBeCloseTo(before - 0.05 + 1.5, 1);
    await page.getByText("Settled shape, not yet run").waitFor({ timeout: 30_000 });
  });

  it("gives way to the face when the plan is another one", async () => {
    const volume = page.getByLabel("Volume", { exact: true }).first();
    await volume.fill("3");
    await volume.press("Tab");
    await readout().waitFor({ state: "detached" });
  });
});

describe("a run that has settled", () => {
  const section = () => page.locator(".section", { hasText: "Add or remove fat" });
  const slider = () => page.getByRole("slider", { name: /^Volume added to/ });
  it("shows what more fat would do", async () => {
    await page.getByRole("navigation", { name: "Steps of the plan" }).getByRole("button", { name: "Run" }).click();
    await page.getByRole("button", { name: "▶ Run" }).click();
    await page.locator(".state-settled").first().waitFor({ timeout: 60_000 });
    await expect.poll(() => figure("Injected"), soon).toBeCloseTo(4.5, 2);
    const lift = await figure("Skin rises");
    const { min, max } = await slider().evaluate((input: HTMLInputElement) => ({
      min: Number(input.min),
      max: Number(input.max),
    }));
    const moveTo = await takeThumb(slider(), -min / (max - min));
    await moveTo((1 - min) / (max - min));
    await readout().waitFor({ timeout: 30_000 });
    await page.mouse.up();
    await page.getByText("Settled shape with this change, not yet injected").waitFor({ timeout: 30_000 });
    expect(await shapeFigure("Skin rises")).toBeGreaterThan(lift);
    expect(await readout().textContent()).toMatch(new RegExp(`now ${lift.toFixed(1)}`));
    await page.waitForTimeout(1000);
    await picture(page, "9-more");
    expect(await wcagProblems(page)).toEqual([]);
  });

  it("goes on with it until it has settled again", async () => {
    const volume = Number(await section().getByLabel("Volume", { exact: true }).inputValue());
    expect(volume).toBeGreaterThan(0.5);
    await page.getByRole("button", { name: "Add to the run" }).click();
    await readout().waitFor({ state: "detached", timeout: 60_000 });
    await expect.poll(() => figure("Injected"), { ...soon, timeout: 60_000 }).toBeCloseTo(4.5 + volume, 2);
    await page.locator(".state-settled").first().waitFor({ timeout: 60_000 });
    expect(await section().getByLabel("Volume", { exact: true }).inputValue()).toBe("0");
    await picture(page, "9-injected");
  });
  it("and all went without a mistake in the page", () => expect(errors).toEqual([]));
});
