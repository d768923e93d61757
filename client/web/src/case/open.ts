// Opens what the daemon has: a patient's case, a run with the plan that it is of, the sample.
import { clone, equals } from "@bufbuild/protobuf";
import { batch } from "@preact/signals";
import { Code, ConnectError } from "@connectrpc/connect";
import { ModelSpecSchema, type Model } from "@wire/model_pb";
import { ScanFormat, type Scan } from "@wire/patient_service_pb";
import { PlanSchema, ScanUnit, type Plan } from "@wire/plan_pb";
import type { SavedPlan } from "@wire/plan_service_pb";
import { SimulationSpecSchema, type Simulation } from "@wire/simulation_pb";
import { attempt, remark } from "../activity";
import { patients, plans, simulations } from "../api/client";
import { collectMeshes } from "../api/meshes";
import { ownerOf } from "../api/runs";
import { uploadScan } from "../api/upload";
import { build, takeLandmarks, takePlan } from "../plan/actions";
import { newPlan } from "../plan/new_plan";
import { createPatient } from "../plan/patient";
import { parsePlan } from "../plan/plan_file";
import { patient, patientName, plan, replacePlan, scan, setModel, specText, startPlan } from "../plan/state";
import { open, runText } from "../run/run";
import { planOfRun } from "../run/state";
import { listTargets, showTarget } from "../target/make_target";
import { beginCase, closeCase, loadMesh, showFace, type Owner } from "./face";
import { keepPlan } from "./keeper";
import { keptDraft, saved, setSaved } from "./saved_plan";

/** Of what may be gone: undefined. */
export async function found<T>(ask: Promise<T>): Promise<T | undefined> {
  try {
    return await ask;
  } catch (error) {
    if (ConnectError.from(error).code === Code.NotFound) return undefined;
    throw error;
  }
}

/** The name is only known where this page sent the file. */
export const fileOf = ({ name, format, unit }: Scan): { name: string; unit: ScanUnit } => ({
  name: `${name.split("/").pop()}.${(ScanFormat[format] ?? "obj").toLowerCase()}`,
  unit,
});

const scanOf = ({ spec }: Model): string => (spec?.geometry.case === "scanRegion" ? spec.geometry.value.scan : "");

async function showScan(owner: Owner, name: string): Promise<void> {
  if (name === scan.value?.name) return;
  const next = await found(patients.getScan({ name }));
  if (next?.complete) showFace(owner, next, await loadMesh(next), fileOf(next));
}

function planOf(model: Model, run: Simulation | undefined): Plan {
  const made = newPlan();
  made.model = model.spec;
  if (run?.spec) made.simulation = clone(SimulationSpecSchema, run.spec);
  if (run?.displayName) made.name = run.displayName;
  return made;
}

/** The face of a model with the plan on it; on the face that is open it can be undone. */
async function showModel(owner: Owner, model: Model, run: Simulation | undefined): Promise<void> {
  const isOpen = scanOf(model) !== "" && scanOf(model) === scan.value?.name;
  const meshes = await collectMeshes(patients.downloadModelMesh({ name: model.name }));
  if (!isOpen) {
    beginCase(owner);
    if (scanOf(model) !== "") await showScan(owner, scanOf(model));
  }
  batch(() => {
    (isOpen ? replacePlan : startPlan)(planOf(model, run));
    setModel(model, meshes);
  });
}

const newest = <T extends { createTime?: { seconds: bigint } }>(all: T[]): T | undefined =>
  [...all].sort((a, b) => Number((b.createTime?.seconds ?? 0n) - (a.createTime?.seconds ?? 0n)))[0];

/** All pages of a list. */
export async function allOf<T>(page: (pageToken: string) => Promise<{ all: T[]; next: string }>): Promise<T[]> {
  const found: T[] = [];
  for (let token = ""; ; ) {
    const { all, next } = await page(token);
    found.push(...all);
    if (next === "") return found;
    token = next;
  }
}

/** The model that was built for the plan of the page, where the daemon has one. */
async function takeModel(): Promise<void> {
  const [of, spec, wanted] = [patient.value, specText.value, plan.value.model!];
  const readMask = { paths: ["name", "spec", "create_time"] };
  const all = await allOf(async (pageToken) => {
    const page = await patients.listModels({ parent: of, pageSize: 1000, pageToken, readMask });
    return { all: page.models, next: page.nextPageToken };
  });
  const built = newest(all.filter((model) => model.spec && equals(ModelSpecSchema, model.spec, wanted)));
  if (built === undefined) return;
  const [model, meshes] = await Promise.all([
    patients.getModel({ name: built.name }),
    collectMeshes(patients.downloadModelMesh({ name: built.name })),
  ]);
  if (specText.value === spec) setModel(model, meshes);
}

async function takeTarget(name: string): Promise<void> {
  const goal = name === "" ? undefined : await found(patients.getScan({ name }));
  if (goal) await Promise.all([showTarget(goal), listTargets()]);
}

/** Shows a plan that the daemon keeps, on its face. */
export async function showSaved(of: SavedPlan, file?: { name: string; unit: ScanUnit }): Promise<void> {
  const owner = await patients.getPatient({ name: ownerOf(of.name) });
  const face = of.scan === "" ? undefined : await patients.getScan({ name: of.scan });
  const mesh = face?.complete ? await loadMesh(face) : undefined;
  batch(() => {
    beginCase(owner);
    if (face && mesh) showFace(owner, face, mesh, file ?? fileOf(face));
    startPlan(of.content ? clone(PlanSchema, of.content) : newPlan());
    setSaved(of);
  });
  await takeModel();
  await takeTarget(of.targetScan);
  if (saved.value?.name === of.name) setSaved(saved.value);
}

/** Opens a run beside the plan that is kept, and says whether that is the plan it was made from. */
export async function openBeside(run: Simulation): Promise<void> {
  const entry = saved.value?.runs.find(({ simulation }) => simulation === run.name);
  open(run, plan.value.model?.geometry.case === "square" ? "skin" : "scan");
  if (entry) planOfRun.value = entry.contentHash === saved.value?.contentHash ? runText.value : "an earlier plan";
}

/** The plan that a run was made from, where one is kept. */
async function savedPlanOf(owner: string, run: string): Promise<SavedPlan | undefined> {
  const readMask = { paths: ["name", "runs"] };
  const all = await allOf(async (pageToken) => {
    const page = await plans.listPlans({ parent: owner, pageSize: 1000, pageToken, readMask });
    return { all: page.plans, next: page.nextPageToken };
  });
  const of = all.find(({ runs }) => runs.some(({ simulation }) => simulation === run));
  return of && plans.getPlan({ name: of.name });
}

/** Shows a run, on its face and with its plan. */
export async function showRun(name: string): Promise<void> {
  const run = await simulations.getSimulation({ name });
  const of = run.spec?.model ?? "";
  const [owner, model] = await Promise.all([
    found(patients.getPatient({ name: ownerOf(of) })),
    found(patients.getModel({ name: of })),
  ]);
  const kept = owner && (await savedPlanOf(owner.name, name));
  if (kept) {
    if (kept.name !== saved.value?.name) await showSaved(kept);
    else setSaved({ ...saved.value, runs: kept.runs }, keptDraft.value);
    return openBeside(run);
  }
  if (owner && model) {
    await showModel(owner, model, run);
  } else {
    closeCase();
    remark.value = "The model of this run is gone: its results are shown, its plan cannot be changed.";
  }
  open(run, model && scanOf(model) === "" ? "skin" : "scan");
  if (model) planOfRun.value = runText.value;
}

export const openRun = (name: string): Promise<boolean> => attempt("Opening the run", () => showRun(name));

/** The newest run of a patient's models. */
export async function runsOf(owner: string): Promise<Simulation[]> {
  const readMask = { paths: ["name", "display_name", "state", "create_time", "summary", "spec.model"] };
  const all = await allOf(async (pageToken) => {
    const page = await simulations.listSimulations({ pageSize: 1000, pageToken, readMask });
    return { all: page.simulations, next: page.nextPageToken };
  });
  return all.filter(({ spec }) => ownerOf(spec?.model ?? "") === owner);
}

/** The plans of a patient, without what is in them. */
export function plansOf(owner: string): Promise<SavedPlan[]> {
  const readMask = { paths: ["name", "title", "update_time"] };
  return allOf(async (pageToken) => {
    const page = await plans.listPlans({ parent: owner, pageSize: 1000, pageToken, readMask });
    return { all: page.plans, next: page.nextPageToken };
  });
}

const newestOf = (all: SavedPlan[]): SavedPlan | undefined =>
  newest(all.map((one) => ({ ...one, createTime: one.updateTime })));

async function newestRun(): Promise<Simulation | undefined> {
  const name = saved.value?.runs[0]?.simulation;
  return name === undefined ? undefined : found(simulations.getSimulation({ name }));
}

/** Another plan of the patient on the page. */
export const openPlan = (name: string): Promise<boolean> =>
  attempt("Opening the plan", async () => {
    await showSaved(await plans.getPlan({ name }));
    const run = await newestRun();
    if (run) await openBeside(run);
  });

/**
 * A case as it was left: the plan that was changed last; without one its newest
 * run, else its newest model, else its newest scan.
 */
export async function showCase(name: string): Promise<void> {
  const kept = newestOf(await plansOf(name));
  if (kept) {
    await showSaved(await plans.getPlan({ name: kept.name }));
    const run = await newestRun();
    return run && openBeside(run);
  }
  const owner = await patients.getPatient({ name });
  const [scans, models, runs] = await Promise.all([
    patients.listScans({ parent: name, pageSize: 1000 }),
    patients.listModels({ parent: name, pageSize: 1000 }),
    runsOf(name),
  ]);
  const model = newest(models.models);
  const run = newest(runs.filter(({ spec }) => spec?.model === model?.name));
  const face = newest(scans.scans.filter(({ complete, report }) => complete && !report?.target));
  if (model) {
    const whole = run && (await simulations.getSimulation({ name: run.name }));
    await showModel(owner, model, whole);
    if (!whole) return;
    open(whole, scanOf(model) === "" ? "skin" : "scan");
    planOfRun.value = runText.value;
    return;
  }
  beginCase(owner);
  if (face) showFace(owner, face, await loadMesh(face), fileOf(face));
}

export const openCase = (name: string): Promise<boolean> => attempt("Opening the case", () => showCase(name));

/** Another scan of the patient on the page. */
export function openScan(name: string): Promise<boolean> {
  return attempt("Loading the face", () => showScan({ name: patient.value, displayName: patientName.value }, name));
}

async function sample(path: string): Promise<Response> {
  const response = await fetch(`samples/${path}`);
  if (!response.ok) throw new Error(`the sample ${path} is not there: this gateway has no --samples`);
  return response;
}

/** The synthetic face that comes with the project, and a plan on it. */
export async function openSample(name = "jaw_angle"): Promise<void> {
  const ready = await attempt("Opening the sample", async (tell) => {
    const next = parsePlan(await (await sample(`plans/${name}.json`)).text());
    const file = next.scan?.file.replace(/^\.\.\//, "") ?? "";
    if (file === "") {
      closeCase();
      return takePlan(next);
    }
    const [face, landmarks] = await Promise.all([
      sample(file).then((r) => r.arrayBuffer()),
      sample(next.scan!.landmarksFile.replace(/^\.\.\//, "")).then((r) => r.text()),
    ]);
    const [owner, unit] = [await createPatient("synthetic-face"), ScanUnit.MILLIMETRE];
    const fileName = file.split("/").pop()!;
    const made = await uploadScan(owner.name, fileName, face, unit, (share) => tell(share, "Sending the face"));
    const mesh = await loadMesh(made);
    batch(() => {
      closeCase();
      showFace(owner, made, mesh, { name: fileName, unit });
      takePlan(next);
      takeLandmarks(landmarks, unit);
      startPlan(plan.value); // nothing of this is to be undone
    });
    await keepPlan(true);
  });
  if (ready) await build();
}
