// One patient at a time: nothing of a face comes to another one, what was done can be taken back,
// and a reload loses nothing.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import type { Download, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { wcagProblems } from "../system/axe";
import { halfFace, halfFaceLandmarks, otherFace } from "../system/faces";
import { listPatients, listScans } from "../system/store";
import { picture, root, System } from "../system/system";

const system = new System();
const errors: string[] = [];
let page: Page;
let other: { scan: string; landmarks: string };

beforeAll(async () => {
  await system.start();
  other = { scan: join(system.folder, "other.obj"), landmarks: join(system.folder, "other.landmarks.json") };
  otherFace(other.scan, other.landmarks);
  page = await system.newPage(errors);
  await page.goto(system.address);
});
afterAll(() => system.stop());
afterEach(async ({ task }) => {
  if (task.result?.state === "fail") await picture(page, "failed-case");
});

const button = (name: string | RegExp) => page.getByRole("button", { name, exact: typeof name === "string" });
const steps = () => page.getByRole("navigation", { name: "Steps of the plan" });
const goTo = (step: string) => steps().getByRole("button", { name: step }).click();
const isSet = (count: number) => page.getByText(`${count} set`, { exact: true }).waitFor();
const undo = () => page.locator("body").press("Control+z");
const redo = () => page.locator("body").press("Control+Shift+z");
const soon = { timeout: 30_000, interval: 300 };
const done = (): Promise<string[]> => page.locator(".steps .done").allTextContents();

async function take(what: string): Promise<string> {
  const [download]: [Download, void] = await Promise.all([page.waitForEvent("download"), button(what).click()]);
  const path = join(system.folder, `taken-${download.suggestedFilename()}`);
  await download.saveAs(path);
  return path;
}

/** Drops a file onto the page, as a hand would. */
async function drop(path: string, name: string): Promise<void> {
  const transfer = await page.evaluateHandle(
    ([text, as]) => {
      const data = new DataTransfer();
      data.items.add(new File([text], as));
      return data;
    },
    [readFileSync(path, "utf8"), name],
  );
  const target = page.locator(".invitation");
  await target.dispatchEvent("dragover", { dataTransfer: transfer });
  await target.dispatchEvent("drop", { dataTransfer: transfer });
}

describe("an empty page", () => {
  it("invites, and no step is done", async () => {
    await page.getByRole("heading", { name: "Plan a fat graft" }).waitFor();
    await picture(page, "8-empty");
    for (const step of ["Face", "Goal", "Tissue", "Fat", "Run"]) {
      await goTo(step);
      expect(await wcagProblems(page), step).toEqual([]);
    }
    await goTo("Face");
    expect(await done()).toEqual([]);
  });

  it("leaves nothing of a scan that is refused", async () => {
    await page.getByLabel("Upload scan…").setInputFiles({
      name: "smith-john.obj",
      mimeType: "text/plain",
      buffer: Buffer.from("v 0 0 0\n"),
    });
    await page.locator(".problem").waitFor();
    await button("Dismiss").click();
    expect(listPatients(system)).toEqual([]);
  });

  it("takes a scan that is dropped, under a pseudonym that is made", async () => {
    await drop(halfFace, "jane-doe.obj");
    await page.getByText("9,991 vertices").waitFor();
    const [patient] = listPatients(system);
    expect(patient.displayName).toMatch(/^case-\d{4}-\d\d-\d\d-[a-z0-9]{5}$/);
    expect(await page.locator(".plan-name b").textContent()).toBe(patient.displayName);
    expect(await done()).toEqual([]);
  });
});

describe("what was done", () => {
  it("refuses the landmarks of another face, with how far they are off", async () => {
    await page.getByLabel("From file…").setInputFiles(other.landmarks);
    await page.getByText(/These landmarks are of another face.*mm off this one/).waitFor();
    await button("Dismiss").click();
    await isSet(0);
  });

  it("refuses a plan of several parts of a face, which it would show one of", async () => {
    await page.getByLabel("Open plan…").setInputFiles(join(root, "client/examples/plans/several_parts.json"));
    await page.getByText(/several parts of a face.*plans one part at a time/).waitFor();
    await button("Dismiss").click();
    expect(await button("Undo").isDisabled()).toBe(true);
  });

  it("is taken back and done again: landmarks", async () => {
    await page.getByLabel("From file…").setInputFiles(halfFaceLandmarks);
    await isSet(11);
    expect(await done()).toEqual(["✓Face"]);
    await undo();
    await isSet(0);
    await redo();
    await isSet(11);
    await button("Remove Nasion").click();
    await isSet(10);
    await button("Undo").click();
    await isSet(11);
  });

  it("is done by keyboard: a landmark", async () => {
    await button("Alare, left").press("Enter");
    await page.locator(".view.after").focus();
    await page.locator(".key-cursor").waitFor();
    for (let k = 0; k < 6; ++k) await page.keyboard.press("ArrowRight");
    await page.keyboard.press("Enter");
    await isSet(12);
    await undo();
    await isSet(11);
  });

  it("leaves what is being typed alone", async () => {
    await page.getByLabel("Name").fill("first plan");
    await page.getByLabel("Name").press("Control+z");
    await isSet(11);
    await page.getByLabel("Name").fill("first plan");
    await page.getByLabel("Name").press("Tab");
    await page.locator(".plan-name", { hasText: "first plan" }).waitFor();
    await undo();
    await page.locator(".plan-name", { hasText: "first plan" }).waitFor({ state: "detached" });
    await redo();
  });

  it("is a stroke of the brush as a whole", async () => {
    await page.getByLabel("Open plan…").setInputFiles(join(root, "client/examples/plans/jaw_angle.json"));
    await goTo("Tissue");
    await button("Build the model").click();
    await page.getByText("2,480 elements").waitFor({ timeout: 60_000 });
    await goTo("Fat");
    await page.getByLabel("Add a zone").selectOption("painted");
    await page.waitForTimeout(1500);
    const { x, y, width, height } = (await page.locator(".view.after").boundingBox())!;
    const stroke = async (from: number): Promise<void> => {
      await page.mouse.move(x + from * width, y + 0.42 * height);
      await page.mouse.down();
      await page.mouse.move(x + (from + 0.05) * width, y + 0.47 * height, { steps: 6 });
      await page.mouse.up();
    };
    const area = async (): Promise<number> =>
      parseFloat(
        /([\d.]+) cm²/.exec((await page.locator(".item", { hasText: "Painted" }).textContent()) ?? "")?.[1] ?? "0",
      );
    /** Once the daemon has said so of the stroke as a whole. */
    const settledArea = async (least: number): Promise<number> => {
      await page.waitForTimeout(2000);
      await expect.poll(area, soon).toBeGreaterThan(least);
      return area();
    };
    await stroke(0.36);
    const first = await settledArea(0.5);
    await stroke(0.48);
    await settledArea(first + 0.3);
    await undo();
    await expect.poll(area, soon).toBeCloseTo(first, 1);
    await redo();
    await expect.poll(area, soon).toBeGreaterThan(first + 0.3);
  });
});

describe("a reload", () => {
  it("loses neither the face, its landmarks, the model nor the plan", async () => {
    expect(page.url()).toMatch(/#plan\/fat\?patient=[a-z0-9-]+&plan=[a-z0-9-]+&scan=[a-z0-9-]+$/);
    await page.waitForTimeout(500);
    await page.reload();
    await page.locator(".item", { hasText: "Painted" }).waitFor({ timeout: 30_000 });
    await expect.poll(() => page.locator(".item", { hasText: /cm²/ }).count(), soon).toBe(3);
    expect(await done()).toEqual(["✓Face", "✓Tissue", "✓Fat"]);
    await goTo("Face");
    await isSet(11);
    await page.goBack();
    await page.locator(".item", { hasText: "Painted" }).waitFor();
    await page.goForward();
    await isSet(11);
  });

  it("comes back to a run, and says when its plan has changed", async () => {
    await goTo("Fat");
    await button("Remove Painted").click();
    await page.getByLabel("Only the settled shape").check();
    await goTo("Run");
    await button("▶ Run").click();
    await page.locator(".state-settled").first().waitFor({ timeout: 60_000 });
    await expect.poll(done, soon).toEqual(["✓Face", "✓Tissue", "✓Fat", "✓Run"]);
    expect(page.url()).toMatch(/run=[a-z0-9-]+$/);
    await page.waitForTimeout(500);
    await page.reload();
    await page.locator(".state-settled").first().waitFor({ timeout: 30_000 });
    await expect.poll(done, soon).toEqual(["✓Face", "✓Tissue", "✓Fat", "✓Run"]);
    await goTo("Fat");
    const volume = page.getByLabel("Volume", { exact: true }).first();
    await volume.fill("2");
    await volume.press("Tab");
    await goTo("Run");
    await page.getByText("The plan has changed since this run").waitFor();
    expect(await done()).not.toContain("✓Run");
    await undo();
    await page.getByText("The plan has changed since this run").waitFor({ state: "detached" });
  });
});

describe("another face", () => {
  let ofFirst = "";
  it("begins a case of its own, without anything of the one before", async () => {
    ofFirst = await take("Plan");
    const before = await page.locator(".plan-name b").textContent();
    await goTo("Face");
    await page.getByLabel("Upload scan…").setInputFiles(other.scan);
    await expect.poll(() => page.locator(".plan-name b").textContent(), soon).not.toBe(before);
    await isSet(0);
    expect(await done()).toEqual([]);
    expect(await button("Undo").isDisabled()).toBe(true);
    expect(page.url()).not.toMatch(/run=/);
    const patients = listPatients(system);
    expect(patients).toHaveLength(2);
    for (const { name } of patients) expect(listScans(system, name)).toHaveLength(1);
  });

  it("does not take the places of a plan that was made on another one", async () => {
    await page.getByLabel("Open plan…").setInputFiles(ofFirst);
    await page.getByText(/This plan was made on .*, not on this face/).waitFor();
    await isSet(0);
    await picture(page, "8-other-plan");
    await button("Dismiss").click();
  });

  it("gives way to the face of a run that is opened", async () => {
    await page.getByLabel("From file…").setInputFiles(other.landmarks);
    await isSet(11);
    const own = await page.locator(".plan-name b").textContent();
    await goTo("Run");
    const runs = page.getByLabel("Of the daemon");
    await runs.focus();
    await expect.poll(() => runs.locator("option").count(), soon).toBeGreaterThan(1);
    await runs.selectOption({ index: 1 });
    await page.locator(".state-settled").first().waitFor({ timeout: 30_000 });
    await expect.poll(() => page.locator(".plan-name b").textContent(), soon).not.toBe(own);
    await goTo("Face");
    await isSet(11);
    const landmarks = JSON.parse(readFileSync(await take("Save"), "utf8")).landmarks as Record<string, number[]>;
    const first = JSON.parse(readFileSync(halfFaceLandmarks, "utf8")).landmarks as Record<string, number[]>;
    expect(landmarks.nasion[0]).toBeCloseTo(first.nasion[0], 3);
    expect(await done()).toEqual(["✓Face", "✓Tissue", "✓Fat", "✓Run"]);
  });

  it("is a case that is opened again as it was left", async () => {
    const patients = listPatients(system);
    const second = patients.find(({ displayName }) => displayName !== "")!;
    const shown = await page.locator(".plan-name b").textContent();
    const next = patients.find(({ displayName }) => displayName !== shown) ?? second;
    await page.getByLabel("Patient", { exact: true }).selectOption(next.name);
    await expect.poll(() => page.locator(".plan-name b").textContent(), soon).toBe(next.displayName);
    await page.goBack();
    await expect.poll(() => page.locator(".plan-name b").textContent(), soon).toBe(shown);
    await isSet(11);
  });

  it("is never the sample's patient", async () => {
    await button("Synthetic sample").click();
    await expect.poll(() => page.locator(".plan-name b").textContent(), soon).toBe("synthetic-face");
    await expect.poll(done, soon).toEqual(["✓Face", "✓Tissue", "✓Fat"]);
    expect(listPatients(system)).toHaveLength(3);
  });
  it("and all went without a mistake in the page", () => expect(errors).toEqual([]));
});
