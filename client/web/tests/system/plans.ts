// Plans that tests make of the samples, and faces that they open with one.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { halfFaceLandmarks, sunkFace } from "./faces";
import { root, type System } from "./system";

/** The paper-size patient, for its settled shape only: a run takes a second or two. */
export function settledPlan(folder: string): string {
  const plan = JSON.parse(readFileSync(join(root, "client/examples/plans/jaw_angle.json"), "utf8"));
  plan.simulation.time = { goal: "SETTLED_SHAPE", end_s: 600 };
  const path = join(folder, "settled.json");
  writeFileSync(path, JSON.stringify(plan));
  return path;
}

/** Opens the page on a face that is sunk by 6 mm, with the paper-size plan; the mL it lacks. */
export async function openSunkFace(page: Page, system: System): Promise<number> {
  await page.goto(system.address);
  const file = join(system.folder, "sunk.obj");
  const { missingMl } = sunkFace(file, 6);
  await page.getByLabel("Upload scan…").setInputFiles(file);
  await page.getByText("9,991 vertices").waitFor();
  await page.getByLabel("From file…").setInputFiles(halfFaceLandmarks);
  await page.getByText("11 set").waitFor();
  await page.getByLabel("Open plan…").setInputFiles(join(root, "client/examples/plans/jaw_angle.json"));
  return missingMl;
}
