// Which field of the form a violation belongs to: it is said once, at the field that is nearest.
import type { Plan } from "@wire/plan_pb";
import { fieldWords, plainWords } from "./field_words";
import type { Violation } from "../api/errors";

/**
 * "spec.films[0].n_xi" of a simulation is "simulation.films[0].n_xi" of the plan; the same for a
 * model.
 */
export function toPlanFields(violations: Violation[], part: "model" | "simulation"): Violation[] {
  return violations.map(({ field, description }) => ({ field: field.replace(/^spec(?=\.|$)/, part), description }));
}

const contains = (outer: string, field: string): boolean =>
  field === outer || field.startsWith(`${outer}.`) || field.startsWith(`${outer}[`);

/** The field of the form that says what is wrong with `field`: the innermost that contains it. */
function placeOf(field: string, shown: Iterable<string>): string | undefined {
  let best: string | undefined;
  for (const place of shown)
    if (contains(place, field) && (best === undefined || place.length > best.length)) best = place;
  return best;
}

const sentence = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);

/**
 * What is said at a field.
 * @param shown  the fields that the form has now
 */
export function descriptionFor(field: string, violations: Violation[], shown: Iterable<string>, plan: Plan): string {
  const places = [...shown];
  const said = violations
    .filter((violation) => placeOf(violation.field, places) === field)
    .map(({ field: inner, description }) =>
      inner === field
        ? sentence(plainWords(description, plan))
        : `${fieldWords(inner, plan)} ${plainWords(description, plan)}`,
    );
  return [...new Set(said)].join("; ");
}

/** What no field of the form says, a sentence each. */
export function elsewhere(violations: Violation[], shown: Iterable<string>, plan: Plan): string[] {
  const places = [...shown];
  const said = violations
    .filter(({ field }) => placeOf(field, places) === undefined)
    .map(({ field, description }) => `${fieldWords(field, plan)} ${plainWords(description, plan)}`);
  return [...new Set(said)];
}
