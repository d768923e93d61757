// A case is one object on the daemon: two windows see one plan, the address opens it anywhere, and
// nothing of one patient comes to another.
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { wcagProblems } from "../system/axe";
import { otherFace } from "../system/faces";
import { listPatients, listPlans, showPlan } from "../system/store";
import { bin, picture, System } from "../system/system";

const system = new System();
const errors: string[] = [];
let one: Page;
let two: Page;
const other = { scan: "", landmarks: "" };
const soon = { timeout: 30_000, interval: 300 };

beforeAll(async () => {
  await system.start();
  other.scan = join(system.folder, "other.obj");
  other.landmarks = join(system.folder, "other.landmarks.json");
  otherFace(other.scan, other.landmarks);
  one = await system.newPage(errors);
  two = await system.newPage(errors, 1024, 768);
  await one.goto(`${system.address}#sample`);
});
afterAll(() => system.stop());
afterEach(async ({ task }) => {
  if (task.result?.state !== "fail") return;
  await picture(one, "failed-saved-one");
  await picture(two, "failed-saved-two");
});

const button = (page: Page, name: string | RegExp) =>
  page.getByRole("button", { name, exact: typeof name === "string" });
const goTo = (page: Page, step: string) =>
  page.getByRole("navigation", { name: "Steps of the plan" }).getByRole("button", { name: step }).click();
const volume = (page: Page) => page.getByLabel("Volume", { exact: true }).first();
const rate = (page: Page) => page.getByLabel("Rate", { exact: true }).first();
const isSaved = (page: Page) => page.locator(".keeping.kept", { hasText: "Saved" }).waitFor();
const caseName = (page: Page) => page.locator(".plan-name b").textContent();
const done = (page: Page): Promise<string[]> => page.locator(".steps .done").allTextContents();
const planName = (page: Page): string => {
  const words = new URLSearchParams(page.url().split("?")[1]);
  return `patients/${words.get("patient")}/plans/${words.get("plan")}`;
};

async function fill(field: ReturnType<typeof volume>, value: string): Promise<void> {
  await field.fill(value);
  await field.press("Tab");
}

async function dismiss(page: Page): Promise<void> {
  await button(page, "Dismiss").click();
}

describe("a plan on the daemon", () => {
  it("is there as soon as there is something of it, and at every change", async () => {
    await expect.poll(() => done(one), { timeout: 60_000, interval: 300 }).toEqual(["✓Face", "✓Tissue", "✓Fat"]);
    await isSaved(one);
    const [plan] = listPlans(system);
    expect(plan.name).toBe(planName(one));
    const before = showPlan(system, plan.name).revision;
    await goTo(one, "Fat");
    await fill(volume(one), "1.25");
    await expect.poll(() => showPlan(system, plan.name).content.simulation.injections[0].volume_ml, soon).toBe(1.25);
    expect(Number(showPlan(system, plan.name).revision)).toBe(Number(before) + 1);
  });

  it("opens by its address in another window as it is", async () => {
    await two.goto(one.url());
    await two.reload();
    await expect.poll(() => volume(two).inputValue(), soon).toBe("1.25");
    expect(await caseName(two)).toBe(await caseName(one));
    await expect.poll(() => done(two), soon).toEqual(["✓Face", "✓Tissue", "✓Fat"]);
  });

  it("takes over what another window changes, and says so", async () => {
    await fill(volume(two), "1.5");
    await expect.poll(() => volume(one).inputValue(), soon).toBe("1.5");
    await one.getByText(/Changed elsewhere at \d\d:\d\d: Volume of injection 1 \(1.25 mL → 1.5 mL\)/).waitFor();
    await dismiss(one);
  });

  it("tells the later of two edits of one field, and takes both of two fields", async () => {
    await system.killDaemon();
    await fill(volume(one), "1.75");
    await one.getByText("Not saved yet: the daemon cannot be reached").waitFor();
    await fill(volume(two), "2.25");
    await fill(rate(two), "0.4");
    await two.getByText("Not saved yet: the daemon cannot be reached").waitFor();
    await system.startDaemon();
    await Promise.all([isSaved(one), isSaved(two)]);
    await expect
      .poll(async () => [await volume(one).inputValue(), await volume(two).inputValue()], soon)
      .toSatisfy(([a, b]: string[]) => a === b);
    await expect.poll(() => rate(one).inputValue(), soon).toBe("0.4");
    const told = /Yours came later and was not taken: Volume of injection 1 (1.75|2.25) mL/;
    const late = (await one.getByText(told).count()) > 0 ? one : two;
    await late.getByText(told).waitFor();
    await picture(late, "9-late-edit");
    for (const page of [one, two]) if ((await page.locator(".remark").count()) > 0) await dismiss(page);
  });

  it("comes back after a reload in the middle of a change", async () => {
    await fill(volume(one), "0.85");
    await one.reload();
    await expect.poll(() => volume(one).inputValue(), soon).toBe("0.85");
    await expect.poll(() => volume(two).inputValue(), soon).toBe("0.85");
    if ((await two.locator(".remark").count()) > 0) await dismiss(two);
  });

  it("has its runs, and says in every window when it has changed since", async () => {
    await one.getByLabel("Only the settled shape").check();
    await goTo(one, "Run");
    await button(one, "▶ Run").click();
    await one.locator(".state-settled").first().waitFor({ timeout: 60_000 });
    await expect.poll(() => showPlan(system, planName(one)).runs.length, soon).toBe(1);
    await two.goto("about:blank");
    await two.goto(one.url());
    await two.locator(".state-settled").first().waitFor(soon);
    expect(await two.getByText("The plan has changed since this run").count()).toBe(0);
    await goTo(one, "Fat");
    await fill(volume(one), "2");
    await two.getByText("The plan has changed since this run").waitFor();
    await one.locator("body").press("Control+z");
    await two.getByText("The plan has changed since this run").waitFor({ state: "detached" });
  });
});

describe("two patients", () => {
  it("never share a plan, whatever the address says", async () => {
    const first = new URLSearchParams(one.url().split("?")[1]);
    await goTo(one, "Face");
    await one.getByLabel("Upload scan…").setInputFiles(other.scan);
    await expect.poll(() => caseName(one), soon).toMatch(/^case-/);
    await one.getByLabel("From file…").setInputFiles(other.landmarks);
    await isSaved(one);
    const second = new URLSearchParams(one.url().split("?")[1]);
    expect(second.get("patient")).not.toBe(first.get("patient"));
    const own = await caseName(one);
    const mixed = [
      `patient=${second.get("patient")}&plan=${first.get("plan")}`,
      `patient=${second.get("patient")}&plan=${second.get("plan")}&run=${first.get("run")}`,
      `patient=${second.get("patient")}&scan=${first.get("scan")}&run=${first.get("run")}`,
    ];
    for (const words of mixed) {
      await one.goto("about:blank");
      await one.goto(`${system.address}#plan/run?${words}`);
      await one.locator(".busy").waitFor({ state: "detached" });
      await expect.poll(() => caseName(one), { message: words, ...soon }).toBeTruthy();
      await one.waitForTimeout(1000);
      const isFirst = one.url().includes(`patient=${first.get("patient")}`);
      if (isFirst) continue; // the run was opened with its own patient, face and plan
      expect(await caseName(one), words).toBe(own);
      expect(one.url(), words).not.toContain("run=");
      expect(await one.locator(".state-settled").count(), words).toBe(0);
    }
    await one.goto(`${system.address}#plan/face?patient=${second.get("patient")}&plan=${second.get("plan")}`);
    await expect.poll(() => caseName(one), soon).toBe(own);
  });

  it("leaves nothing of another scan that is refused", async () => {
    const { name } = listPatients(system).find(({ displayName }) => displayName.startsWith("case-"))!;
    await one.getByLabel("Another scan of this patient…").setInputFiles({
      name: "smith-john.obj",
      mimeType: "text/plain",
      buffer: Buffer.from("v 0 0 0\n"),
    });
    await one.locator(".problem").waitFor();
    await dismiss(one);
    const server = `127.0.0.1:${system.daemonPort}`;
    const listed = String(execFileSync(join(bin, "lipofill"), ["scan", "list", name, "--server", server]));
    expect(listed.trim().split("\n")).toHaveLength(1);
  });
});

describe("the list of cases", () => {
  it("shows each with its picture, side, state and date, and finds by any word", async () => {
    await one.getByRole("link", { name: "Cases" }).click();
    const rows = one.locator(".case");
    await expect.poll(() => rows.count(), soon).toBe(2);
    await expect.poll(() => one.locator(".case-picture img").count(), soon).toBe(2);
    await expect.poll(() => one.locator(".case-state").allTextContents(), soon).toContain("Result");
    expect(await wcagProblems(one)).toEqual([]);
    await picture(one, "9-cases");
    await one.getByLabel("Search").fill("synthetic result");
    await expect.poll(() => rows.count(), soon).toBe(1);
    await one.getByLabel("Search").fill("");
    await one.getByLabel("State").selectOption("planned");
    await expect.poll(() => rows.count(), soon).toBe(1);
    await one.getByLabel("State").selectOption("");
    await one.getByLabel("Side").selectOption({ label: "Right" });
    await expect.poll(() => rows.count(), soon).toBe(0);
    await one.getByLabel("Side").selectOption({ label: "Left" });
    await one.getByLabel("Search").fill("synthetic");
    await expect.poll(() => one.locator(".case-label").allTextContents(), soon).toEqual(["synthetic-face"]);
  });

  it("opens a case as it was left", async () => {
    await one.locator(".case").first().click();
    await expect.poll(() => caseName(one), soon).toBe("synthetic-face");
    await goTo(one, "Face");
    await one.getByText("11 set", { exact: true }).waitFor();
    expect(listPlans(system)).toHaveLength(2);
  });
  it("and all went without a mistake in the page", () => expect(errors).toEqual([]));
});
