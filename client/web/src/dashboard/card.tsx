// A simulation on the wall: face, pseudonym, figures, how far it has come.
import { readable } from "../plan/anatomy";
import { stateClass, stateWord } from "../run/exports";
import { writeAddress } from "../case/address";
import { bandOf, cssOf, pressureBands } from "../scene/colour_maps";
import { alarmsOf, isLive, ownerOf, pressureOf, progressOf, timeLeft, type Card } from "./cards";

export const nameOf = ({ displayName, name }: Card["simulation"]): string => displayName || name.split("/")[1];
export const addressOf = (run: string): string =>
  writeAddress({ page: "plan", step: "run", patient: "", plan: "", scan: "", run });

interface Props {
  card: Card;
  picture: string | undefined;
  /** pseudonyms by patient */
  patients: ReadonlyMap<string, string>;
}

export function CardOf({ card, picture, patients }: Props) {
  const { simulation, seen } = card;
  const summary = simulation.summary;
  const pressure = pressureOf(simulation);
  const wanted = (simulation.spec?.injections ?? []).reduce((sum, { volumeMl }) => sum + (volumeMl ?? 0), 0);
  const [alarms, left, running] = [alarmsOf(card), timeLeft(card), isLive(simulation)];
  const owner = ownerOf(simulation);
  const name = nameOf(simulation);
  return (
    <article
      class={`card ${stateClass(simulation)} ${running ? "" : "ended"} ${alarms.length > 0 ? "alarmed" : ""}`}
      aria-label={name}
    >
      <header>
        <h2>
          <a href={addressOf(simulation.name)} title="Open in the planner">
            {patients.get(owner) ?? owner.split("/")[1] ?? ""} <span>{name}</span>
          </a>
        </h2>
        <span class="state">
          {stateWord(simulation)}
          {simulation.parked && ", parked"}
        </span>
      </header>
      <div class="card-body">
        <div class="thumb">
          {picture ? <img src={picture} alt="The face as it is now" /> : <span class="quiet">no picture yet</span>}
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
        </dl>
      </div>
      {running && (
        <div class="card-progress">
          <progress value={progressOf(simulation)} max={1} aria-label={`${readable(name)}, time that has passed`} />
          <small>
            {(summary?.timeS ?? 0).toFixed(1)} s{left && `, ${left}`}
            {seen.stepsPerS > 0 && `, ${seen.stepsPerS.toFixed(0)} steps/s`}
          </small>
        </div>
      )}
      {alarms.map((alarm) => (
        <p class="complaint" key={alarm}>
          {alarm}
        </p>
      ))}
    </article>
  );
}
