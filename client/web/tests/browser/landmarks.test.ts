// Landmarks with help: a guess to confirm, one click a point, what is dragged, sides taken for each
// other.
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { wcagProblems } from "../system/axe";
import { halfFace, halfFaceLandmarks } from "../system/faces";
import { picture, root, System } from "../system/system";

const system = new System();
const errors: string[] = [];
let page: Page;

beforeAll(async () => {
  await system.start();
  page = await system.newPage(errors);
  await page.goto(system.address);
  await page.getByLabel("Upload scan…").setInputFiles(halfFace);
  await page.getByText("9,991 vertices").waitFor();
});
afterAll(() => system.stop());
afterEach(async ({ task }) => {
  if (task.result?.state === "fail") await picture(page, "failed-landmarks");
});

const button = (name: string | RegExp) => page.getByRole("button", { name, exact: typeof name === "string" });
const isSet = (count: number) => page.getByText(`${count} set`, { exact: true }).waitFor();
async function clickAt(x: number, y: number): Promise<void> {
  const box = (await page.locator(".view.after").boundingBox())!;
  await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
}

describe("landmarks", () => {
  it("are placed one click each, in order, with a picture of where", async () => {
    await button("Front").click();
    await button("Place one by one").click();
    const asked = page.locator(".guided b");
    expect(await asked.textContent()).toBe("Nasion");
    expect(await page.locator(".landmark-picture").getAttribute("aria-label")).toBe("Where nasion is on a face");
    await clickAt(0.4, 0.4);
    await isSet(1);
    expect(await asked.textContent()).toBe("Pronasale");
    await button("Skip").click();
    expect(await asked.textContent()).toBe("Subnasale");
    await page.waitForTimeout(800);
    await picture(page, "11-guided");
    expect(await wcagProblems(page)).toEqual([]);
    await page.keyboard.press("Escape");
    await page.locator("body").press("Control+z");
    await isSet(0);
  });

  it("are not guessed where a face has no second side, and the page says so", async () => {
    await button("Guess the landmarks").click();
    await page.getByText(/click the landmarks by hand/).waitFor({ timeout: 60_000 });
    await button("Dismiss").click();
  });

  it("are seen to be swapped, and put right with one press", async () => {
    const file = JSON.parse(readFileSync(halfFaceLandmarks, "utf8")) as { landmarks: Record<string, number[]> };
    const { cheilion_left: left, cheilion_right: right } = file.landmarks;
    Object.assign(file.landmarks, { cheilion_left: right, cheilion_right: left });
    await page.getByLabel("From file…").setInputFiles({
      name: "swapped.json",
      mimeType: "application/json",
      buffer: Buffer.from(JSON.stringify(file)),
    });
    await isSet(11);
    await page.getByText(/Left and right look swapped: cheilion/).waitFor();
    await picture(page, "11-swapped");
    await button("Swap them").click();
    await page.getByText(/look swapped/).waitFor({ state: "detached" });
  });

  it("are dragged where they belong", async () => {
    await button("Front").click();
    await page.waitForTimeout(1200);
    const labels = page.locator(".face-labels .landmark", { hasText: "Pogonion" });
    const box = (await labels.boundingBox())!;
    const [x, y] = [box.x - 8, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 25, y, { steps: 5 });
    await page.mouse.up();
    await page.waitForTimeout(800);
    const after = (await labels.boundingBox())!;
    expect(after.x - box.x).toBeGreaterThan(15);
    await page.locator("body").press("Control+z");
    await page.waitForTimeout(800);
    expect((await labels.boundingBox())!.x).toBeCloseTo(box.x, 0);
  });
});

const mask = join(root, "../shared/data/faces/mask_03.ply");
describe.skipIf(!existsSync(mask))("a whole face", () => {
  it("gets a guess of each, which counts once it is confirmed", async () => {
    await page.getByLabel("Upload scan…").setInputFiles(mask);
    await page.getByText("7,160 vertices").waitFor({ timeout: 60_000 });
    await button("Guess the landmarks").click();
    const all = button(/^Confirm \d+ guesses$/);
    await all.waitFor({ timeout: 80_000 });
    const count = Number(/\d+/.exec((await all.textContent())!)![0]);
    expect(count).toBeGreaterThanOrEqual(13);
    await isSet(0);
    expect(await page.locator(".steps .done").count()).toBe(0);
    await page.waitForTimeout(1200);
    await picture(page, "11-guessed");
    expect(await wcagProblems(page)).toEqual([]);
    await button("Confirm Nasion").click();
    await isSet(1);
    await button(/^Confirm \d+ guesses$/).click();
    await isSet(count);
    expect(await page.locator(".steps .done").allTextContents()).toEqual(["✓Face"]);
    expect(await page.getByText(/look swapped/).count()).toBe(0);
  });
  it("and all went without a mistake in the page", () => expect(errors).toEqual([]));
});
