// The plan of the page as the daemon keeps it: what the page has to say to it, and what it last
// heard.
import { clone, equals } from "@bufbuild/protobuf";
import { batch, computed, signal } from "@preact/signals";
import { PlanSchema, type Plan } from "@wire/plan_pb";
import { PlanSide, type SavedPlan } from "@wire/plan_service_pb";
import { canUndo, patient, plan, scan } from "../plan/state";
import { target } from "../target/state";

/** as it was last read or written; undefined while the daemon has none */
export const saved = signal<SavedPlan | undefined>(undefined);
/** what the page had when it was, to tell what it has changed since */
export const keptDraft = signal<Draft | undefined>(undefined);
/** "kept": what is on the page is on the daemon. */
export const keeping = signal<"kept" | "saving" | "waiting" | "refused">("kept");

/** What is only of this page, or of a model that was built for it, stays here. */
export function contentOf(of: Plan): Plan {
  const content = clone(PlanSchema, of);
  [content.scan, content.bone] = [undefined, undefined];
  if (content.simulation) content.simulation.model = "";
  return content;
}

/** The daemon's rule for what people read: nothing that a person's name fits into. */
export const titleOf = ({ name }: Plan): string =>
  name
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, "-")
    .replace(/^-+/, "")
    .slice(0, 63);

/** The side that fat goes into, by the names of zones and regions. */
export function sideOf({ simulation }: Plan): PlanSide {
  const names = (simulation?.films ?? []).flatMap(({ zones }) =>
    zones.map(({ name, shape }) => (shape.case === "region" ? shape.value : name)),
  );
  const left = names.some((name) => name.endsWith("_left"));
  const right = names.some((name) => name.endsWith("_right"));
  if (left && right) return PlanSide.BOTH_SIDES;
  return left ? PlanSide.LEFT_SIDE : right ? PlanSide.RIGHT_SIDE : PlanSide.PLAN_SIDE_UNSPECIFIED;
}

/** What is to be kept of the page. */
export interface Draft {
  parent: string;
  title: string;
  side: PlanSide;
  scan: string;
  targetScan: string;
  content: Plan;
}

export const draft = computed<Draft>(() => ({
  parent: patient.value,
  title: titleOf(plan.value),
  side: sideOf(plan.value),
  scan: scan.value?.name ?? "",
  targetScan: target.value?.name ?? "",
  content: contentOf(plan.value),
}));

/** The fields of a plan that differ, as an update names them. */
export function differences(now: Draft, before: Draft): string[] {
  const differs: [string, boolean][] = [
    ["title", now.title !== before.title],
    ["side", now.side !== before.side],
    ["scan", now.scan !== before.scan],
    ["target_scan", now.targetScan !== before.targetScan],
    ["content", !equals(PlanSchema, now.content, before.content)],
  ];
  return differs.filter(([, is]) => is).map(([field]) => field);
}

/** The page shows what the daemon has. */
export function setSaved(next: SavedPlan | undefined, shown?: Draft): void {
  batch(() => {
    saved.value = next;
    keptDraft.value = next && (shown ?? draft.value);
  });
}

/** A page that only looks at something keeps nothing. */
export const hasNews = computed(
  () =>
    patient.value !== "" &&
    (keptDraft.value === undefined ? canUndo.value : differences(draft.value, keptDraft.value).length > 0),
);
