// Every case that the caller may see: to search, to open, to begin.
import { computed, signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { PlanSide } from "@wire/plan_service_pb";
import { busy } from "../activity";
import { closeCase } from "../case/face";
import { allOf, openCase } from "../case/open";
import { page } from "../case/restore";
import { patients, plans, simulations } from "../api/client";
import { toProblem } from "../api/errors";
import { step } from "../stage/stage_state";
import { patient } from "../plan/state";
import { CasePictures } from "./case_pictures";
import { chosen, dateWords, rowsOf, stateWords, type CaseRow, type CaseState, type Wanted } from "./case_rows";

const rows = signal<CaseRow[] | undefined>(undefined);
const trouble = signal("");
const pictures = signal(new Map<string, string>());
const nothing: Wanted = { search: "", side: PlanSide.PLAN_SIDE_UNSPECIFIED, state: "", order: "date" };
const wanted = signal<Wanted>(nothing);
const shown = computed(() => chosen(rows.value ?? [], wanted.value));
const lookEveryMs = 3000;
/** So many rows are drawn at once; to find others one searches. */
const mostRows = 200;
/** A look asks for the faces of so many cases. */
const mostAsked = 20;

const sideWords = new Map([
  [PlanSide.PLAN_SIDE_UNSPECIFIED, "–"],
  [PlanSide.LEFT_SIDE, "Left"],
  [PlanSide.RIGHT_SIDE, "Right"],
  [PlanSide.BOTH_SIDES, "Both"],
]);

const planMask = { paths: ["name", "title", "side", "scan", "content_hash", "update_time", "runs"] };
const runMask = { paths: ["name", "state", "display_name", "create_time", "spec.model"] };

/** Scans by patient, of cases whose face no plan names: asked for once. */
const scans = new Map<string, string>();

async function findFaces(of: CaseRow[]): Promise<CaseRow[]> {
  const open = of.filter(({ name, scan, state }) => scan === "" && state !== "new" && !scans.has(name));
  for (const { name } of open.slice(0, mostAsked)) {
    const { scans: found } = await patients.listScans({ parent: name, pageSize: 10 });
    // A target is a scan as well; the face was there before.
    scans.set(name, found.find(({ report }) => report?.target === undefined)?.name ?? "");
  }
  return of.map((row) => (row.scan === "" ? { ...row, scan: scans.get(row.name) ?? "" } : row));
}

async function look(): Promise<void> {
  try {
    const [known, kept, runs] = await Promise.all([
      allOf(async (pageToken) => {
        const next = await patients.listPatients({ pageSize: 1000, pageToken });
        return { all: next.patients, next: next.nextPageToken };
      }),
      allOf(async (pageToken) => {
        const next = await plans.listPlans({ parent: "patients/-", pageSize: 1000, pageToken, readMask: planMask });
        return { all: next.plans, next: next.nextPageToken };
      }),
      allOf(async (pageToken) => {
        const next = await simulations.listSimulations({ pageSize: 1000, pageToken, readMask: runMask });
        return { all: next.simulations, next: next.nextPageToken };
      }),
    ]);
    [rows.value, trouble.value] = [await findFaces(rowsOf(known, kept, runs)), ""];
  } catch (error) {
    trouble.value = toProblem(error).message;
  }
}

const change = (next: Partial<Wanted>): void => void (wanted.value = { ...wanted.value, ...next });

async function show(row: CaseRow): Promise<void> {
  if (row.name !== patient.value && !(await openCase(row.name))) return;
  page.value = "plan";
}

function begin(): void {
  closeCase();
  [page.value, step.value] = ["plan", "face"];
}

function Filters() {
  return (
    <form class="case-filters" role="search" onSubmit={(event) => event.preventDefault()}>
      <div class="field grow">
        <label for="case-search">Search</label>
        <input
          id="case-search"
          type="search"
          value={wanted.value.search}
          onInput={(event) => change({ search: event.currentTarget.value })}
        />
      </div>
      <div class="field">
        <label for="case-side">Side</label>
        <select
          id="case-side"
          value={wanted.value.side}
          onChange={(event) => change({ side: Number(event.currentTarget.value) })}
        >
          {[...sideWords].map(([side, word]) => (
            <option key={side} value={side}>
              {side === PlanSide.PLAN_SIDE_UNSPECIFIED ? "All" : word}
            </option>
          ))}
        </select>
      </div>
      <div class="field">
        <label for="case-state">State</label>
        <select
          id="case-state"
          value={wanted.value.state}
          onChange={(event) => change({ state: event.currentTarget.value as CaseState | "" })}
        >
          <option value="">All</option>
          {Object.entries(stateWords).map(([state, word]) => (
            <option key={state} value={state}>
              {word}
            </option>
          ))}
        </select>
      </div>
      <div class="field">
        <label for="case-order">Order</label>
        <select
          id="case-order"
          value={wanted.value.order}
          onChange={(event) => change({ order: event.currentTarget.value as Wanted["order"] })}
        >
          <option value="date">Last changed first</option>
          <option value="name">By pseudonym</option>
        </select>
      </div>
      <button type="button" class="button primary" onClick={begin}>
        New case
      </button>
    </form>
  );
}

function Row({ row }: { row: CaseRow }) {
  const url = pictures.value.get(row.scan);
  return (
    <li>
      <button type="button" class="case" disabled={busy.value !== undefined} onClick={() => void show(row)}>
        <span class="case-picture" aria-hidden="true">
          {url ? <img src={url} alt="" /> : <span>{row.scan === "" ? "no face" : "…"}</span>}
        </span>
        <b class="case-label">{row.label}</b>
        <span class="case-title">
          {row.title || "–"}
          {row.plans > 1 && <small> and {row.plans - 1} more</small>}
        </span>
        <span>{sideWords.get(row.side)}</span>
        <span class={`case-state ${row.state}`}>{stateWords[row.state]}</span>
        <span class="quiet">{dateWords(row.changedS)}</span>
      </button>
    </li>
  );
}

function Summary() {
  const [all, some] = [rows.value?.length, shown.value.length];
  const more = some > mostRows ? `; the first ${mostRows} are shown` : "";
  return (
    <p class="quiet" role="status">
      {trouble.value && <span class="complaint">{trouble.value} Trying again.</span>}
      {all !== undefined && (some === all ? `${all} cases` : `${some} of ${all} cases`) + more}
    </p>
  );
}

export function CaseList() {
  useEffect(() => {
    const drawn = new CasePictures((scan, url) => (pictures.value = new Map(pictures.value).set(scan, url)));
    const end = shown.subscribe((now) => drawn.want(now.slice(0, mostRows).map(({ scan }) => scan)));
    void look();
    const timer = setInterval(() => void look(), lookEveryMs);
    return () => {
      clearInterval(timer);
      end();
      drawn.dispose();
      pictures.value = new Map();
    };
  }, []);
  return (
    <main class="cases">
      <h1>Cases</h1>
      <Filters />
      <Summary />
      <ul class="case-rows">
        {shown.value.slice(0, mostRows).map((row) => (
          <Row key={row.name} row={row} />
        ))}
      </ul>
      {rows.value?.length === 0 && <p class="empty">No cases yet: a scan that is dropped on the planner begins one.</p>}
    </main>
  );
}
