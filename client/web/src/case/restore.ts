// Keeps the page and its address together: what happens goes into the address, and an address that
// is opened, reloaded or gone back to brings the page to where it was.
import { batch, computed, effect, signal } from "@preact/signals";
import { attempt } from "../activity";
import { patients, simulations } from "../api/client";
import { collectMeshes } from "../api/meshes";
import { builtFrom, model, patient, plan, scan, scanFile, setModel, startPlan } from "../plan/state";
import { open } from "../run/run";
import { planOfRun, recorded, simulation } from "../run/state";
import { step } from "../stage/stage_state";
import { tool } from "../plan/tools";
import { listTargets, showTarget } from "../target/make_target";
import { target } from "../target/state";
import { parseAddress, writeAddress, type Address } from "./address";
import { beginCase, closeCase, loadMesh, showFace } from "./face";
import { found, openSample, showCase, showRun } from "./open";
import { keep, recall, type Kept } from "./kept";

const keptAfterMs = 300;

export const page = signal(parseAddress(location.hash).page);
/** The page is being brought to an address: what happens meanwhile is no news. */
const restoring = signal(false);

export const address = computed<Address>(() => ({
  page: page.value,
  step: step.value,
  patient: patient.value,
  scan: scan.value?.name ?? "",
  run: recorded.value === "" ? (simulation.value?.name ?? "") : "",
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
  });
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

async function restoreRun(name: string, planText: string): Promise<void> {
  const run = name === "" ? undefined : await found(simulations.getSimulation({ name }));
  if (!run) return;
  open(run, plan.value.model?.geometry.case === "square" ? "skin" : "scan");
  planOfRun.value = planText;
}

async function bring(to: Address): Promise<void> {
  const kept = recall(to.patient);
  if (kept?.scan === to.scan && (to.patient !== "" || to.run === "")) {
    await showKept(to.patient, kept);
    await restoreRun(to.run, kept.planOfRun);
  } else if (to.run !== "") await showRun(to.run);
  else if (to.patient !== "") await showCase(to.patient);
  else closeCase();
}

const isSameCase = (one: Address, other: Address): boolean =>
  one.patient === other.patient && one.scan === other.scan && one.run === other.run;

/** Brings the page to what the address bar says by then. */
async function goToAddress(isFirst = false): Promise<void> {
  const to = parseAddress(location.hash);
  restoring.value = true;
  batch(() => {
    [page.value, step.value, tool.value] = [to.page, to.step, { kind: "turn" }];
  });
  if (to.page === "plan" && (isFirst || !isSameCase(to, address.value)))
    await attempt("Opening the case", () => bring(to));
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
    effect(() => {
      void [plan.value, scan.value, model.value, target.value, planOfRun.value];
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
