// Every simulation the caller may see, for a screen on the wall.
import { computed, signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { Simulation_State, type Simulation } from "@wire/simulation_pb";
import { patients, simulations } from "../api/client";
import { toProblem } from "../api/errors";
import { allOf } from "../case/open";
import { addressOf, CardOf, nameOf } from "./card";
import { alarmsOf, choose, ownerOf, see, type Card, type Seen } from "./cards";
import { Thumbnails } from "./thumbnails";

const cards = signal<Card[]>([]);
const trouble = signal("");
/** how long the daemon took to answer [ms] */
const answered = signal<number | undefined>(undefined);
const pictures = signal(new Map<string, string>());
const pseudonyms = signal<ReadonlyMap<string, string>>(new Map());
const lookEveryMs = 1000;
const slowMs = 3000;

const alarms = computed(() =>
  cards.value.flatMap((card) => alarmsOf(card).map((text) => ({ text, simulation: card.simulation }))),
);

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
    "recovery",
    "spec.injections",
    "spec.model",
    "spec.time",
  ],
};

async function listAll(signal: AbortSignal): Promise<Simulation[]> {
  return allOf(async (pageToken) => {
    const page = await simulations.listSimulations({ pageSize: 1000, pageToken, readMask }, { signal });
    return { all: page.simulations, next: page.nextPageToken };
  });
}

/** Asked for when somebody new is there. */
async function learnNames(all: Simulation[], signal: AbortSignal): Promise<void> {
  const owners = all.map(ownerOf).filter((owner) => owner !== "" && !pseudonyms.value.has(owner));
  if (owners.length === 0) return;
  const known = await allOf(async (pageToken) => {
    const page = await patients.listPatients({ pageSize: 1000, pageToken }, { signal });
    return { all: page.patients, next: page.nextPageToken };
  });
  // Those who are gone keep their id, and are not asked for again.
  const names = new Map(owners.map((owner) => [owner, owner.split("/")[1]]));
  for (const { name, displayName } of known) names.set(name, displayName || name.split("/")[1]);
  pseudonyms.value = names;
}

async function look(leave: AbortSignal, before: Map<string, Seen>): Promise<void> {
  const began = performance.now();
  try {
    const all = choose(await listAll(leave));
    const now = performance.now();
    answered.value = now - began;
    cards.value = all.map((simulation) => {
      const seen = see(simulation, before.get(simulation.name), now);
      before.set(simulation.name, seen);
      return { simulation, seen };
    });
    trouble.value = "";
    await learnNames(all, leave);
  } catch (error) {
    if (!leave.aborted) trouble.value = toProblem(error).message;
  }
}

function Totals() {
  const count = (state: Simulation_State): number =>
    cards.value.filter(({ simulation }) => simulation.state === state).length;
  const isSlow = (answered.value ?? 0) > slowMs;
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
      {trouble.value ? (
        <span class="alarm">{trouble.value} Trying again.</span>
      ) : (
        answered.value !== undefined && (
          <span class={isSlow ? "alarm" : ""}>
            {isSlow ? `The daemon takes ${(answered.value / 1000).toFixed(0)} s to answer` : "The daemon answers"}
          </span>
        )
      )}
    </div>
  );
}

function Alarms() {
  if (alarms.value.length === 0) return null;
  return (
    <ul class="alarms" role="alert" aria-label="Alarms">
      {alarms.value.slice(0, 3).map(({ text, simulation }) => (
        <li key={`${simulation.name} ${text}`}>
          <a href={addressOf(simulation.name)}>
            <b>{pseudonyms.value.get(ownerOf(simulation)) ?? nameOf(simulation)}</b> {text}
          </a>
        </li>
      ))}
      {alarms.value.length > 3 && <li>and {alarms.value.length - 3} more</li>}
    </ul>
  );
}

export function Dashboard() {
  useEffect(() => {
    const leave = new AbortController();
    const before = new Map<string, Seen>();
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
      <Alarms />
      <div class="cards" tabIndex={0} role="group" aria-label="All simulations">
        {cards.value.map((card) => (
          <CardOf
            key={card.simulation.name}
            card={card}
            picture={pictures.value.get(card.simulation.name)}
            patients={pseudonyms.value}
          />
        ))}
      </div>
      {cards.value.length === 0 && !trouble.value && <p class="empty">No simulations yet.</p>}
    </main>
  );
}
