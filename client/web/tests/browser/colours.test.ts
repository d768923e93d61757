// A scan with colours of its vertices: the face has them, and the result lies on them.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { halfFace, halfFaceLandmarks } from "../system/faces";
import { settledPlan } from "../system/plans";
import { PictureReader, type Box } from "../system/pixels";
import { picture, System } from "../system/system";

const system = new System();
const errors: string[] = [];
let page: Page;
let reader: PictureReader;

const green = [40, 150, 60];
const blue = [50, 70, 190];
const soon = { timeout: 30_000, interval: 300 };

/** The half face, green above the middle of its height and blue below. */
function colouredFace(): string {
  const lines = readFileSync(halfFace, "utf8").split("\n");
  const heights = lines.filter((line) => line.startsWith("v ")).map((line) => Number(line.split(/\s+/)[3]));
  const middle = (Math.min(...heights) + Math.max(...heights)) / 2;
  const coloured = lines.map((line) => {
    if (!line.startsWith("v ")) return line;
    const colour = Number(line.split(/\s+/)[3]) > middle ? green : blue;
    return `${line.trim()} ${colour.map((value) => (value / 255).toFixed(4)).join(" ")}`;
  });
  const path = join(system.folder, "coloured.obj");
  writeFileSync(path, coloured.join("\n"));
  return path;
}

/** The face, without what lies over it. */
async function middle(): Promise<Box> {
  const box = (await page.locator(".stage").boundingBox())!;
  const share = (of: number, by: number): number => Math.round(of * by);
  return {
    x: Math.round(box.x) + share(box.width, 0.25),
    y: Math.round(box.y) + 190,
    width: share(box.width, 0.5),
    height: Math.round(box.height) - 380,
  };
}
/** Pixels of the two colours in the picture. */
async function found(name: string): Promise<[number, number]> {
  await page.waitForTimeout(1000);
  const [shot, box] = [await picture(page, name), await middle()];
  return [await reader.ofHue(shot, box, green), await reader.ofHue(shot, box, blue)];
}
const scanned = () => page.getByRole("button", { name: "Scanned colours" });

beforeAll(async () => {
  await system.start();
  page = await system.newPage(errors);
  reader = await PictureReader.open(page);
  await page.goto(system.address);
  await page.getByLabel("Upload scan…").setInputFiles(colouredFace());
  await page.getByText("9,991 vertices").waitFor();
});
afterAll(() => system.stop());
afterEach(async ({ task }) => {
  if (task.result?.state === "fail") await picture(page, "failed-colours");
});

describe("a scan with colours", () => {
  it("is seen in them, and without them where that is wanted", async () => {
    expect(await scanned().getAttribute("aria-pressed")).toBe("true");
    const [above, below] = await found("16-scanned");
    expect(above).toBeGreaterThan(5000);
    expect(below).toBeGreaterThan(5000);
    await scanned().click();
    expect(await found("16-plain")).toEqual([0, 0]);
    await scanned().click();
    expect((await found("16-again"))[0]).toBeGreaterThan(0.9 * above);
  });

  it("keeps them under a result, also beside the face before", async () => {
    await page.getByLabel("From file…").setInputFiles(halfFaceLandmarks);
    await page.getByLabel("Open plan…").setInputFiles(settledPlan(system.folder));
    await page.getByRole("navigation", { name: "Steps of the plan" }).getByRole("button", { name: "Run" }).click();
    await page.getByRole("button", { name: "▶ Run" }).click();
    await page.locator(".state-settled").first().waitFor({ timeout: 60_000 });
    await page.getByRole("radio", { name: "Skin" }).click();
    await page.getByRole("button", { name: "Front" }).click();
    const [above, below] = await found("16-result");
    expect(above + below).toBeGreaterThan(5000);
    await page.getByRole("radio", { name: "Displacement" }).click();
    const [, tinted] = await found("16-displacement");
    expect(tinted, "the lift lies on the skin").toBeGreaterThan(1000);
    await page.getByRole("radio", { name: "Side by side" }).click();
    const [aboveBoth, belowBoth] = await found("16-beside");
    expect(aboveBoth + belowBoth).toBeGreaterThan(5000);
    await page.getByRole("radio", { name: "After" }).click();
    await expect.poll(() => page.evaluate(() => document.querySelectorAll(".view.before canvas").length), soon).toBe(0);
    expect(errors).toEqual([]);
  });
});
