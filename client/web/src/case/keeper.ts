// Keeps the plan of the page on the daemon: at every change, one call after the other, put together
// with what others change meanwhile.
import { create, equals } from "@bufbuild/protobuf";
import { batch, effect } from "@preact/signals";
import { Code, ConnectError } from "@connectrpc/connect";
import { PlanSchema, type Plan } from "@wire/plan_pb";
import type { SavedPlan } from "@wire/plan_service_pb";
import { remark, tell } from "../activity";
import { newId, plans } from "../api/client";
import { isLost } from "../api/errors";
import { plan, replacePlan } from "../plan/state";
import { mergeWords } from "./change_words";
import { mergePlans } from "./merge";
import { contentOf, differences, draft, hasNews, keeping, keptDraft, saved, setSaved, type Draft } from "./saved_plan";

const pauseMs = 250;
const againMs = 2000;
const lookMs = 2000;

let underWay: Promise<void> = Promise.resolve();
/** of the case on the page: what is answered for another one by then is not of this page */
let generation = 0;
let last = "";

const codeOf = (error: unknown): Code => ConnectError.from(error).code;

/** Where a plan is to be kept, and what the page had when it last was. */
interface Ground {
  onto: SavedPlan | undefined;
  before: Draft | undefined;
}

function send(now: Draft, { onto, before }: Ground): Promise<SavedPlan> {
  const { parent, ...fields } = now;
  if (onto === undefined || before === undefined) return plans.createPlan({ requestId: newId(), parent, plan: fields });
  const updateMask = { paths: differences(now, before) };
  return plans.updatePlan({ plan: { ...fields, name: onto.name, etag: onto.etag }, updateMask });
}

const ground = (): Ground => ({ onto: saved.value, before: keptDraft.value });

export const timeOf = (kept: SavedPlan): Date => new Date(Number(kept.updateTime?.seconds ?? 0n) * 1000);

/** The page takes what others changed, with what it changed itself. */
export function takeOver(theirs: SavedPlan, base: Plan): void {
  const ours = contentOf(plan.value);
  const content = theirs.content ?? create(PlanSchema);
  const merge = mergePlans(base, ours, content);
  batch(() => {
    setSaved(theirs, { ...draft.value, content });
    if (!equals(PlanSchema, merge.plan, ours)) {
      merge.plan.scan = plan.value.scan;
      replacePlan(merge.plan);
    }
    const words = mergeWords(merge, timeOf(theirs));
    if (words !== "") remark.value = words;
  });
}

async function lateEdit(of: number, { onto, before }: Ground): Promise<void> {
  const theirs = await plans.getPlan({ name: onto!.name });
  if (of === generation) takeOver(theirs, before!.content);
}

/** The plan is gone from the daemon: what is on the page is kept as a new one. */
function wasDeleted(of: number): void {
  if (of !== generation) return;
  setSaved(undefined);
  remark.value = "This plan was deleted elsewhere. It is kept again, as a new one.";
  void keepPlan(true);
}

function refuse(of: number, error: unknown): void {
  if (of !== generation) return;
  // Who may only look is not told at every change.
  keeping.value = "refused";
  const { message } = ConnectError.from(error);
  if (message !== last && codeOf(error) !== Code.PermissionDenied) tell(error);
  last = message;
}

async function keepOnce(force: boolean): Promise<void> {
  const [of, now, where] = [generation, draft.value, ground()];
  const isNew = where.onto === undefined;
  if (now.parent === "" || !(hasNews.value || (force && isNew))) return;
  keeping.value = "saving";
  try {
    const next = await send(now, where);
    if (of !== generation) return;
    setSaved(next, now);
    [keeping.value, last] = ["kept", ""];
  } catch (error) {
    if (codeOf(error) === Code.Aborted && !isNew) await lateEdit(of, where);
    else if (codeOf(error) === Code.NotFound && !isNew) wasDeleted(of);
    else if (isLost(error)) waitAndKeep(of);
    else refuse(of, error);
  }
}

function waitAndKeep(of: number): void {
  if (of !== generation) return;
  keeping.value = "waiting";
  setTimeout(() => void keepPlan(), againMs);
}

/** Keeps the plan now; with `force` also one that nobody has changed yet. Resolves once done. */
export function keepPlan(force = false): Promise<void> {
  underWay = underWay.then(() => keepOnce(force)).catch(tell);
  return underWay;
}

/** Leaves the case: what was not kept yet is kept, whatever comes to the page meanwhile. */
export function leavePlan(): void {
  const [now, where] = [draft.value, ground()];
  if (hasNews.value && keeping.value !== "refused")
    underWay = underWay.then(() => send(now, where)).then(() => undefined, tell);
  ++generation;
  setSaved(undefined);
  [keeping.value, last] = ["kept", ""];
}

/** Notes a run that was made from what `of` is. */
export async function noteRun(simulation: string, of: SavedPlan | undefined): Promise<void> {
  if (of === undefined) return;
  try {
    const { runs } = await plans.addPlanRun({ name: of.name, simulation, contentHash: of.contentHash });
    if (saved.value?.name === of.name) saved.value = { ...saved.value, runs };
  } catch (error) {
    if (codeOf(error) !== Code.PermissionDenied) tell(error);
  }
}

/** Looks whether others have changed the plan. */
async function look(): Promise<void> {
  const [of, where] = [generation, ground()];
  const { onto } = where;
  if (onto === undefined || keeping.value !== "kept" || document.hidden) return;
  try {
    const now = await plans.getPlan({ name: onto.name, readMask: { paths: ["etag", "runs"] } });
    if (of !== generation || saved.value !== onto) return;
    if (now.etag !== onto.etag) await lateEdit(of, where);
    else if (now.runs.length !== onto.runs.length) saved.value = { ...onto, runs: now.runs };
  } catch (error) {
    if (codeOf(error) === Code.NotFound && of === generation) wasDeleted(of);
    else if (!isLost(error)) refuse(of, error);
  }
}

const lookNow = (): void => void (underWay = underWay.then(look).catch(tell));

/** From the start of the page to its end. */
export function bindKeeper(): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const end = effect(() => {
    void draft.value;
    if (!hasNews.value) return;
    clearTimeout(timer);
    timer = setTimeout(() => void keepPlan(), pauseMs);
  });
  const looking = setInterval(lookNow, lookMs);
  window.addEventListener("focus", lookNow);
  return () => {
    end();
    clearTimeout(timer);
    clearInterval(looking);
    window.removeEventListener("focus", lookNow);
  };
}
