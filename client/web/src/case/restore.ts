// Keeps the page and its address together: what happens goes into the address, and an address that
// is opened, reloaded or gone back to brings the page to where it was.
import { batch, computed, effect, signal } from "@preact/signals";
import type { Simulation } from "@wire/simulation_pb";
import { attempt, remark } from "../activity";
import { patients, plans, simulations } from "../api/client";
import { collectMeshes } from "../api/meshes";
import { ownerOf } from "../api/runs";
import { builtFrom, model, patient, plan, replacePlan, scan, scanFile, setModel, startPlan } from "../plan/state";
import { goToMoment, keepMoment } from "../run/kept_moment";
import { open } from "../run/run";
import { frame, lookedAt, planOfRun, recorded, simulation } from "../run/state";
import { holdCamera, stillCamera, stillMoment } from "../stage/camera";
import { step } from "../stage/stage_state";
import { tool } from "../plan/tools";
import { listTargets, showTarget } from "../target/make_target";
import { target } from "../target/state";
import { parseAddress, writeAddress, type Address } from "./address";
import { beginCase, closeCase, loadMesh, showFace } from "./face";
import { found, openBeside, openSample, showCase, showRun, showSaved } from "./open";
import { bindKeeper, takeOver } from "./keeper";
import { keep, recall, type Kept } from "./kept";
import { hasNews, saved } from "./saved_plan";

const keptAfterMs = 300;

export const page = signal(parseAddress(location.hash).page);
/** The page is being brought to an address: what happens meanwhile is no news. */
const restoring = signal(false);

export const address = computed<Address>(() => ({
  page: page.value,
  step: step.value,
  patient: patient.value,
  plan: saved.value?.name ?? "",
  scan: scan.value?.name ?? "",
  run: recorded.value === "" ? (simulation.value?.name ?? "") : "",
  camera: stillCamera.value,
  momentS: stillMoment.value,
}));

/** Everything that the daemon does not know. */
function keepNow(): void {
  if (restoring.value) return;
  keep(patient.value, {
    plan: plan.value,
    scan: scan.value?.name ?? "",
    file: scanFile.value,
    model: model.value?.name ?? "",
    builtFrom: builtFrom.value,
    target: target.value?.name ?? "",
    planOfRun: planOfRun.value,
    saved: saved.value?.name ?? "",
    etag: saved.value?.etag ?? "",
    hasNews: hasNews.value,
  });
  keepMoment(address.value.run, lookedAt.value === undefined ? undefined : frame.value);
}

/** The moment of the run that an address names. */
function restoreMoment({ run, momentS }: Address): void {
  if (momentS === undefined || run === "" || run !== simulation.value?.name) return;
  if (goToMoment(run, momentS)) return;
  remark.value = `The moment at ${momentS.toFixed(2)} s is not held any more: the newest is shown.`;
}

async function showKept(of: string, kept: Kept): Promise<void> {
  const owner = of === "" ? undefined : await patients.getPatient({ name: of });
  closeCase();
  if (owner && kept.scan !== "") {
    const face = await patients.getScan({ name: kept.scan });
    showFace(owner, face, await loadMesh(face), kept.file);
  } else if (owner) beginCase(owner);
  startPlan(kept.plan);
  const built = kept.model === "" ? undefined : await found(patients.getModel({ name: kept.model }));
  if (built) setModel(built, await collectMeshes(patients.downloadModelMesh({ name: built.name })), kept.builtFrom);
  if (kept.target === "") return;
  const goal = await found(patients.getScan({ name: kept.target }));
  if (goal) await Promise.all([showTarget(goal), listTargets()]);
}

/** A run of another patient than the page's is never shown beside this face. */
async function runOfCase(name: string): Promise<Simulation | undefined> {
  const run = name === "" ? undefined : await found(simulations.getSimulation({ name }));
  if (!run || patient.value === "" || ownerOf(run.spec?.model ?? "") === patient.value) return run;
  remark.value = "The address names a run of another patient. It is not shown.";
  return undefined;
}

async function restoreRun(name: string, planText: string): Promise<void> {
  const run = await runOfCase(name);
  if (!run) return;
  open(run, plan.value.model?.geometry.case === "square" ? "skin" : "scan");
  planOfRun.value = planText;
}

/** What the tab has of a plan that the daemon has yet to keep. */
async function takeUnkept(kept: Kept | undefined): Promise<void> {
  const now = saved.value;
  if (!kept?.hasNews || now === undefined || kept.saved !== now.name) return;
  replacePlan(kept.plan);
  if (kept.etag === now.etag) return;
  // Others have changed it since: what they began from is in its history.
  const before = await found(plans.getPlanRevision({ name: now.name, revision: BigInt(parseInt(kept.etag) || 0) }));
  if (before?.content) takeOver(now, before.content);
}

/** Whether the plan is there and was brought. */
async function bringPlan(name: string, to: Address, kept: Kept | undefined): Promise<boolean> {
  const plan = name === "" ? undefined : await found(plans.getPlan({ name }));
  if (plan === undefined) return false;
  await showSaved(plan, kept?.scan === plan.scan ? kept.file : undefined);
  await takeUnkept(kept);
  const run = await runOfCase(to.run);
  if (run) await openBeside(run);
  return true;
}

async function bring(to: Address): Promise<void> {
  const kept = recall(to.patient);
  const isOfTab = kept !== undefined && kept.scan === to.scan && to.patient !== "";
  if (await bringPlan(to.plan || (isOfTab ? kept.saved : ""), to, kept)) return;
  if (kept?.scan === to.scan && (to.patient !== "" || to.run === "")) {
    await showKept(to.patient, kept);
    await restoreRun(to.run, kept.planOfRun);
  } else if (to.run !== "") await showRun(to.run);
  else if (to.patient !== "") await showCase(to.patient);
  else closeCase();
}

/** An address that names no plan is that of the plan which came of it. */
const isSameCase = (to: Address, now: Address): boolean =>
  to.patient === now.patient &&
  (to.plan === "" || to.plan === now.plan) &&
  (to.scan === now.scan || (to.scan === "" && to.plan !== "")) &&
  to.run === now.run;

/** Brings the page to what the address bar says by then. */
async function goToAddress(isFirst = false): Promise<void> {
  const to = parseAddress(location.hash);
  restoring.value = true;
  batch(() => {
    [page.value, step.value, tool.value] = [to.page, to.step, { kind: "turn" }];
  });
  holdCamera(to.camera, to.scan);
  if (to.page === "plan" && (isFirst || !isSameCase(to, address.value)))
    await attempt("Opening the case", () => bring(to));
  restoreMoment(to);
  [stillCamera.value, stillMoment.value] = [to.camera, lookedAt.value];
  // What is gone cannot be brought.
  if (to.page === page.value) history.replaceState(null, "", writeAddress(address.value));
  restoring.value = false;
}

/** One after the other: who goes back twice comes to the second. */
let going = Promise.resolve();
const back = (): void => void (going = going.then(() => goToAddress()));

/** Steps and cases are places to come back to; a scan or a run of the same case is not another. */
function say(): void {
  const [now, before] = [address.value, parseAddress(location.hash)];
  const text = writeAddress(now);
  if (restoring.value || text === location.hash) return;
  const isNews =
    location.hash !== "" && (now.page !== before.page || now.step !== before.step || now.patient !== before.patient);
  history[isNews ? "pushState" : "replaceState"](null, "", text);
}

/** From the start of the page to its end. */
export function bindAddress(): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  if (location.hash === "#sample") {
    history.replaceState(null, "", "#plan/face");
    void openSample();
  } else going = goToAddress(true);
  const ends = [
    effect(say),
    bindKeeper(),
    effect(() => {
      void [plan.value, scan.value, model.value, target.value, planOfRun.value, saved.value, stillMoment.value];
      clearTimeout(timer);
      timer = setTimeout(keepNow, keptAfterMs);
    }),
  ];
  window.addEventListener("popstate", back);
  window.addEventListener("pagehide", keepNow);
  return () => {
    clearTimeout(timer);
    ends.forEach((end) => end());
    window.removeEventListener("popstate", back);
    window.removeEventListener("pagehide", keepNow);
  };
}
