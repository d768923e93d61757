// A whole plan in a real browser, on the real daemon: from a scan to what is taken home.
import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { Download, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { pressureBands, zoneColours } from "../../src/scene/colour_maps";
import { wcagProblems } from "../system/axe";
import { PictureReader, type Box } from "../system/pixels";
import { bin, picture, root, System } from "../system/system";

const system = new System();
const errors: string[] = [];
/** what the page has asked the daemon for, by method */
const calls: string[] = [];
let page: Page;
let reader: PictureReader;

beforeAll(async () => {
  await system.start();
  page = await system.newPage(errors);
  page.on("request", (request) => calls.push(new URL(request.url()).pathname.split("/").at(-1)!));
  reader = await PictureReader.open(page);
  await page.goto(system.address);
});
afterAll(() => system.stop());
afterEach(async ({ task }) => {
  if (task.result?.state === "fail") await picture(page, "failed-plan");
});

const button = (name: string | RegExp) => page.getByRole("button", { name, exact: typeof name === "string" });
const goTo = (step: string) =>
  page.getByRole("navigation", { name: "Steps of the plan" }).getByRole("button", { name: step }).click();
const figure = async (label: string): Promise<number> =>
  parseFloat((await page.locator(`[data-figure="${label}"]`).textContent())!);

/** The middle of the picture, without what lies over it. */
async function middle(): Promise<Box> {
  const box = (await page.locator(".stage").boundingBox())!;
  return {
    x: Math.round(box.x + box.width * 0.15),
    y: Math.round(box.y + 110),
    width: Math.round(box.width * 0.62),
    height: Math.round(box.height - 220),
  };
}

/** The picture once it has stopped changing, on a machine however busy. */
async function still(name: string): Promise<Buffer> {
  let before = await picture(page, name);
  for (let tries = 0; tries < 20; ++tries) {
    await page.waitForTimeout(400);
    const now = await picture(page, name);
    if (now.equals(before)) return now;
    before = now;
  }
  return before;
}

/**
 * Waits until the picture is as it should be: the daemon and a browser without a graphics card take
 * their time.
 */
const soon = { timeout: 30_000, interval: 500 };

async function take(what: string): Promise<string> {
  const [download]: [Download, void] = await Promise.all([page.waitForEvent("download"), button(what).click()]);
  const path = join(system.folder, download.suggestedFilename());
  await download.saveAs(path);
  return path;
}

describe("a plan", () => {
  it("begins with a scan that is uploaded, and landmarks from a file", async () => {
    await page.getByLabel("Upload scan…").setInputFiles(join(root, "client/examples/faces/half_face.obj"));
    await page.getByText("9,991 vertices").waitFor();
    await page.getByLabel("From file…").setInputFiles(join(root, "client/examples/faces/half_face.landmarks.json"));
    await page.getByText("11 set").waitFor();
    expect(await wcagProblems(page)).toEqual([]);
  });

  it("has landmarks that are set and corrected by clicking", async () => {
    const before = await still("1-landmarks");
    await button("Alare, left").click();
    const { x, y, width, height } = (await page.locator(".view.after").boundingBox())!;
    await page.mouse.click(x + 0.53 * width, y + 0.5 * height);
    await page.getByText("12 set").waitFor();
    const after = await still("1-landmark-clicked");
    const around = {
      x: Math.round(x + 0.53 * width - 15),
      y: Math.round(y + 0.5 * height - 15),
      width: 30,
      height: 30,
    };
    expect(await reader.differ(before, after, around), "a ball where the click was").toBeGreaterThan(30);
    await button("Remove Alare, left").click();
    await page.getByText("11 set").waitFor();
  });

  it("is turned by dragging", async () => {
    const before = await still("1-front");
    const { x, y, width, height } = await middle();
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    for (let step = 1; step <= 8; ++step) {
      await page.mouse.move(x + width / 2 - 20 * step, y + height / 2 + 2 * step);
      await page.waitForTimeout(60);
    }
    await page.mouse.up();
    const box = await middle();
    await expect
      .poll(async () => reader.differ(before, await picture(page, "1-turned"), box), soon)
      .toBeGreaterThan(5000);
  });

  it("is opened from a file, and its model is built with progress", async () => {
    await page.getByLabel("Open plan…").setInputFiles(join(root, "client/examples/plans/jaw_angle.json"));
    await goTo("Tissue");
    expect(await wcagProblems(page)).toEqual([]);
    await button("Build the model").click();
    await page.getByText("2,480 elements").waitFor({ timeout: 60_000 });
    await page.getByLabel("See the layers").check();
    await still("2-layers");
    await page.getByLabel("See the layers").uncheck();
  });

  it("shows its zones where the daemon places them", async () => {
    await goTo("Fat");
    const box = await middle();
    for (const k of [0, 1])
      await expect
        .poll(async () => reader.ofHue(await picture(page, "3-zones"), box, zoneColours[k]), soon)
        .toBeGreaterThan(8000);
    expect(await wcagProblems(page)).toEqual([]);
  });

  it("says beside a field what the daemon has against it", async () => {
    const volume = page.getByLabel("Volume").first();
    await volume.fill("1000");
    await volume.press("Tab");
    await page.locator(".injection .complaint").first().waitFor();
    expect(await page.locator(".injection .complaint").first().textContent()).toMatch(/1000 mL/);
    await still("3-violation");
    await volume.fill("3");
    await volume.press("Tab");
    await page.locator(".injection .complaint").first().waitFor({ state: "detached" });
  });

  it("has zones painted by hand and injection points by clicking", async () => {
    await page.getByLabel("Add a zone").selectOption("painted");
    const { x, y, width, height } = (await page.locator(".view.after").boundingBox())!;
    // In front of the other two zones.
    await page.mouse.move(x + 0.37 * width, y + 0.4 * height);
    await page.mouse.down();
    await page.mouse.move(x + 0.4 * width, y + 0.5 * height, { steps: 8 });
    await page.mouse.up();
    const painted = await still("3-painted");
    expect(await reader.ofHue(painted, await middle(), zoneColours[2]), "paint").toBeGreaterThan(2500);
    await page.keyboard.press("Escape");
    await button("Place the point").first().click();
    await page.mouse.click(x + 0.56 * width, y + 0.42 * height);
    await button("Move the point").waitFor();
    await page.waitForTimeout(1200);
    expect(await page.locator(".complaint").allTextContents()).toEqual([]);
  });

  it("has the areas of its zones, and what is worth knowing of it", async () => {
    await expect.poll(() => page.getByText(/, [\d.]+ cm²/).count(), soon).toBe(3);
    const end = page.getByLabel("Ends at the latest after");
    const before = await end.inputValue();
    await end.fill("0.1");
    await end.press("Tab");
    await page.getByText(/what is left of them will not be injected/).waitFor();
    await end.fill(before);
    await end.press("Tab");
    await page.getByText(/what is left of them/).waitFor({ state: "detached" });
  });

  it("is only asked about: no simulation is made before one is run", () => {
    const server = `127.0.0.1:${system.daemonPort}`;
    const listed = execFileSync(join(bin, "lipofill"), ["simulation", "list", "--json", "--server", server]);
    expect(JSON.parse(String(listed)).simulations).toEqual([]);
    expect(calls).toContain("CheckPlan");
    expect(calls).not.toContain("CreateSimulation");
  });
});

describe("a run", () => {
  it("moves the skin, and colours it", async () => {
    await page.getByLabel("Watch in real time").check();
    await goTo("Run");
    const before = await still("4-before");
    const box = await middle();
    await page.locator("body").click({ position: { x: 860, y: 24 } });
    await page.keyboard.press("Space");
    await page.locator(".state-running").waitFor();
    await page.waitForFunction(
      () => parseFloat(document.querySelector('[data-figure="Injected"]')?.textContent ?? "0") > 2,
      undefined,
      { timeout: 30_000 },
    );
    // At once: a busy machine may take as long for a picture as the run takes to settle.
    await button(/Pause/).click();
    await page.locator(".state-paused").waitFor();
    const during = await picture(page, "4-running");
    expect(await reader.differ(before, during, box), "the cheek moves").toBeGreaterThan(8000);
    expect(await figure("Skin rises")).toBeGreaterThan(1);
  });

  it("has the daemon's refusal beside the field", async () => {
    const more = page.locator(".section", { hasText: "Inject more" });
    await more.getByLabel("Rate").fill("-1");
    await more.getByLabel("Rate").press("Tab");
    await button("Inject").click();
    await more.locator(".complaint").waitFor();
    await button("Dismiss").click();
    await more.getByLabel("Rate").fill("1");
    await more.getByLabel("Rate").press("Tab");
  });

  it("takes more fat while it is paused, and goes on", async () => {
    const injected = await figure("Injected");
    const more = page.locator(".section", { hasText: "Inject more" });
    await more.getByLabel("Volume").fill("0.5");
    await more.getByLabel("Volume").press("Tab");
    await button("Inject").click();
    await button(/Resume/).click();
    await page.waitForFunction(
      (least) => parseFloat(document.querySelector('[data-figure="Injected"]')?.textContent ?? "0") > least,
      injected + 0.2,
      { timeout: 30_000 },
    );
  });

  it("shows pressure in its bands, and the probe says what is under the cursor", async () => {
    await page.waitForFunction(
      () => parseFloat(document.querySelector('[data-figure="Injected"]')?.textContent ?? "0") >= 4.99,
      undefined,
      { timeout: 30_000 },
    );
    // On a busy machine it may have settled before the button is reached.
    const ended = page.locator(".state-stopped, .state-settled").waitFor();
    await Promise.race([
      button(/Stop/)
        .click()
        .catch(() => undefined),
      ended,
    ]);
    await ended;
    await page.getByRole("radio", { name: "Pressure" }).click();
    const shown = await still("4-pressure");
    const box = await middle();
    const counts = await Promise.all(pressureBands.map(({ colour }) => reader.ofHue(shown, box, colour)));
    expect(
      counts.reduce((sum, n) => sum + n, 0),
      "bands",
    ).toBeGreaterThan(10_000);
    const { x, y, width, height } = (await page.locator(".view.after").boundingBox())!;
    await page.mouse.move(x + 0.57 * width, y + 0.4 * height);
    await page.mouse.move(x + 0.58 * width, y + 0.41 * height);
    const probe = page.locator(".probe");
    await probe.waitFor();
    expect(await probe.textContent()).toMatch(/mm displaced.*mmHg in .* mm of fat/s);
    await picture(page, "4-probe");
    expect(await wcagProblems(page)).toEqual([]);
  });

  it("goes back through time", async () => {
    const time = page.getByLabel("Simulated time");
    const late = await figure("Injected");
    await time.fill("0.3");
    await expect.poll(() => figure("Injected"), soon).toBeLessThan(late / 2);
    await button("Newest").click();
    expect(await figure("Injected")).toBeCloseTo(late, 5);
  });

  it("is beside the face before, and under a slider", async () => {
    await page.getByRole("radio", { name: "Displacement" }).click();
    await page.getByRole("radio", { name: "Side by side" }).click();
    await still("4-side-by-side");
    await page.getByRole("radio", { name: "Slider" }).click();
    const half = await still("4-slider");
    await page.getByLabel("Share of the picture before").fill("0");
    expect(
      await reader.differ(half, await still("4-slider-after"), await middle()),
      "the slider uncovers",
    ).toBeGreaterThan(2000);
    await page.getByRole("radio", { name: "After" }).click();
  });

  it("is compared with a target", async () => {
    await page.getByLabel("Compare with a scan…").setInputFiles(join(root, "client/examples/faces/half_face.obj"));
    await page.getByRole("cell", { name: /mm/ }).first().waitFor({ timeout: 60_000 });
    await still("4-target");
    expect(await page.getByRole("radio", { name: "Goal" }).getAttribute("aria-checked")).toBe("true");
  });

  it("fits a tablet", async () => {
    await page.setViewportSize({ width: 1024, height: 768 });
    await still("4-tablet");
    const overflow = await page.evaluate(() =>
      [...document.querySelectorAll<HTMLElement>(".panel-body, .figures, .top")]
        .filter((one) => one.scrollWidth > one.clientWidth + 1)
        .map((one) => one.className),
    );
    expect(overflow).toEqual([]);
    await page.setViewportSize({ width: 1440, height: 900 });
  });
});

describe("what is taken home", () => {
  it("is a plan that the command line carries out as it is", async () => {
    await goTo("Fat");
    await page.getByLabel("Watch in real time").uncheck();
    await goTo("Run");
    const plan = await take("Plan");
    copyFileSync(join(root, "client/examples/faces/half_face.obj"), join(system.folder, "half_face.obj"));
    const out = join(system.folder, "result");
    execFileSync(join(bin, "lipofill"), ["run", plan, "--out", out, "--fast", "--spawn"], { stdio: "pipe" });
    expect(JSON.parse(readFileSync(join(out, "summary.json"), "utf8")).state).toBe("SETTLED");
  });
  it("is figures, a surface and a picture", async () => {
    const csv = readFileSync(await take("CSV"), "utf8")
      .trim()
      .split("\n");
    expect(csv[0]).toMatch(/^step,time_s,step_ms,injected_ml/);
    expect(csv.length).toBeGreaterThan(100);
    const vertices = readFileSync(await take("Mesh"), "utf8")
      .split("\n")
      .filter((line) => line.startsWith("v "));
    expect(vertices).toHaveLength(9991);
    expect(
      readFileSync(await take("Picture"))
        .subarray(1, 4)
        .toString(),
    ).toBe("PNG");
  });
  it("is opened again from its folder", async () => {
    await button("Close").click();
    await page.getByLabel("Result folder…").setInputFiles(join(system.folder, "result"));
    await page.getByText("Recorded").waitFor({ timeout: 30_000 });
    await page.getByRole("radio", { name: "Displacement" }).click();
    // With what was injected while it ran.
    expect(await figure("Injected")).toBeCloseTo(5, 2);
    const shown = await still("5-recorded");
    expect(await reader.ofHue(shown, await middle(), [36, 98, 164]), "blue where it moved").toBeGreaterThan(1500);
    expect(existsSync(join(system.folder, "result/scan.pvd"))).toBe(true);
  });
});

describe("the dashboard", () => {
  it("shows every simulation with its figures and a picture", async () => {
    await page.getByRole("link", { name: "Dashboard" }).click();
    const card = page.getByRole("article", { name: "jaw-angle" });
    await card.getByText(/Stopped|Settled/).waitFor();
    await card.getByAltText("The face as it is now").waitFor({ timeout: 20_000 });
    await still("6-dashboard");
    expect(await card.textContent()).toMatch(/5\.0 \/ 5\.0 mL/);
    expect(await wcagProblems(page)).toEqual([]);
  });
  it("and all went without a mistake in the page", () => expect(errors).toEqual([]));
});
