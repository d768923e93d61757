// Every simulation the caller may see, for a screen on the wall.
import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { Simulation_State, type Simulation } from "@wire/simulation_pb";
import { simulations } from "../api/client";
import { toProblem } from "../api/errors";
import { stateClass, stateWord } from "../run/exports";
import { writeAddress } from "../case/address";
import { bandOf, cssOf, mmHgPerPa, pressureBands } from "../scene/colour_maps";
import { Thumbnails } from "./thumbnails";

interface Card {
  simulation: Simulation;
  /** steps a second of the clock, between the last two looks */
  stepsPerS: number;
}

const cards = signal<Card[]>([]);
const trouble = signal("");
const pictures = signal(new Map<string, string>());
const lookEveryMs = 1000;
/** Of what ended, only so many of the newest. */
const mostEnded = 24;

const order: Simulation_State[] = [
  Simulation_State.FAILED,
  Simulation_State.RUNNING,
  Simulation_State.QUEUED,
  Simulation_State.PAUSED,
  Simulation_State.READY,
  Simulation_State.SETTLED,
  Simulation_State.FINISHED,
  Simulation_State.STOPPED,
];
const rank = ({ state }: Simulation): number => order.indexOf(state);
const age = ({ createTime }: Simulation): number => -Number(createTime?.seconds ?? 0n);
const live = [Simulation_State.RUNNING, Simulation_State.QUEUED, Simulation_State.PAUSED, Simulation_State.READY];
const isLive = ({ state }: Simulation): boolean => live.includes(state);
/** What cards show: plans with painted zones are long. */
const readMask = {
  paths: [
    "name",
    "display_name",
    "state",
    "reason",
    "summary",
    "viewers",
    "create_time",
    "queue_position",
    "parked",
    "spec.injections",
  ],
};

async function listAll(signal: AbortSignal): Promise<Simulation[]> {
  const all: Simulation[] = [];
  for (let pageToken = ""; ; ) {
    const page = await simulations.listSimulations({ pageSize: 1000, pageToken, readMask }, { signal });
    all.push(...page.simulations);
    if (page.nextPageToken === "") return all;
    pageToken = page.nextPageToken;
  }
}

function choose(all: Simulation[]): Simulation[] {
  const ended = all
    .filter((one) => !isLive(one))
    .sort((a, b) => age(a) - age(b))
    .slice(0, mostEnded);
  return [...all.filter(isLive), ...ended].sort((a, b) => rank(a) - rank(b) || age(a) - age(b));
}

async function look(leave: AbortSignal, before: Map<string, { steps: bigint; at: number }>): Promise<void> {
  try {
    const all = choose(await listAll(leave));
    const now = performance.now();
    cards.value = all.map((simulation) => {
      const steps = simulation.summary?.steps ?? 0n;
      const last = before.get(simulation.name);
      before.set(simulation.name, { steps, at: now });
      const stepsPerS =
        last === undefined || simulation.state !== Simulation_State.RUNNING
          ? 0
          : (1000 * Number(steps - last.steps)) / (now - last.at);
      return { simulation, stepsPerS };
    });
    trouble.value = "";
  } catch (error) {
    if (!leave.aborted) trouble.value = toProblem(error).message;
  }
}

function Entry({ card: { simulation, stepsPerS } }: { card: Card }) {
  const summary = simulation.summary;
  const pressure = (summary?.maxPressurePa ?? 0) * mmHgPerPa;
  const word = stateWord(simulation);
  const wanted = (simulation.spec?.injections ?? []).reduce((sum, { volumeMl }) => sum + (volumeMl ?? 0), 0);
  return (
    <article class={`card ${stateClass(simulation)}`} aria-label={simulation.displayName || simulation.name}>
      <header>
        <h2>{simulation.displayName || simulation.name.split("/")[1]}</h2>
        <span class="state">
          {word}
          {simulation.parked && ", parked"}
        </span>
      </header>
      <div class="card-body">
        <div class="thumb">
          {pictures.value.get(simulation.name) ? (
            <img src={pictures.value.get(simulation.name)} alt="The face as it is now" />
          ) : (
            <span class="quiet">no picture yet</span>
          )}
        </div>
        <dl>
          <div>
            <dt>Volume</dt>
            <dd>
              {(summary?.injectedMl ?? 0).toFixed(1)}
              <small> / {wanted.toFixed(1)} mL</small>
            </dd>
          </div>
          <div>
            <dt>Pressure</dt>
            <dd>
              <i
                class="swatch"
                style={{ background: cssOf(pressureBands[bandOf(pressure)].colour) }}
                aria-hidden="true"
              />
              {pressure.toFixed(1)}
              <small> mmHg</small>
            </dd>
          </div>
          <div>
            <dt>Skin rises</dt>
            <dd>
              {(summary?.skinMaxDisplacementMm ?? 0).toFixed(1)}
              <small> mm</small>
            </dd>
          </div>
          <div>
            <dt>Rate</dt>
            <dd>
              {stepsPerS.toFixed(0)}
              <small> steps/s</small>
            </dd>
          </div>
          <div>
            <dt>Time</dt>
            <dd>
              {(summary?.timeS ?? 0).toFixed(1)}
              <small> s</small>
            </dd>
          </div>
          <div>
            <dt>Viewers</dt>
            <dd>{simulation.viewers}</dd>
          </div>
        </dl>
      </div>
      <a href={writeAddress({ page: "plan", step: "run", patient: "", plan: "", scan: "", run: simulation.name })}>
        Open in the planner
      </a>
      {simulation.state === Simulation_State.FAILED && <p class="complaint">{simulation.reason}</p>}
    </article>
  );
}

function Totals() {
  const count = (state: Simulation_State): number =>
    cards.value.filter(({ simulation }) => simulation.state === state).length;
  return (
    <div class="totals" role="status">
      <span>
        <b>{count(Simulation_State.RUNNING)}</b> running
      </span>
      <span>
        <b>{count(Simulation_State.QUEUED)}</b> queued
      </span>
      <span>
        <b>{count(Simulation_State.PAUSED)}</b> paused
      </span>
      <span class={count(Simulation_State.FAILED) > 0 ? "alarm" : ""}>
        <b>{count(Simulation_State.FAILED)}</b> failed
      </span>
      <span>
        <b>{cards.value.length}</b> shown
      </span>
      {trouble.value && <span class="alarm">{trouble.value} Trying again.</span>}
    </div>
  );
}

export function Dashboard() {
  useEffect(() => {
    const leave = new AbortController();
    const before = new Map<string, { steps: bigint; at: number }>();
    const thumbnails = new Thumbnails((name, url) => (pictures.value = new Map(pictures.value).set(name, url)));
    let timer: ReturnType<typeof setTimeout>;
    const turn = async (): Promise<void> => {
      await look(leave.signal, before);
      thumbnails.want(cards.value.map(({ simulation }) => simulation));
      if (!leave.signal.aborted) timer = setTimeout(() => void turn(), lookEveryMs);
    };
    void turn();
    return () => {
      leave.abort();
      clearTimeout(timer);
      thumbnails.dispose();
    };
  }, []);
  return (
    <main class="dashboard">
      <h1 class="sr-only">Simulations</h1>
      <Totals />
      <div class="cards">
        {cards.value.map((card) => (
          <Entry key={card.simulation.name} card={card} />
        ))}
      </div>
      {cards.value.length === 0 && !trouble.value && <p class="empty">No simulations yet.</p>}
    </main>
  );
}
