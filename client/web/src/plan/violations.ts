// Which field of the form a violation belongs to.
import type { Violation } from "../api/errors";

/**
 * "spec.films[0].n_xi" of a simulation is "simulation.films[0].n_xi" of the plan; the same for a
 * model.
 */
export function toPlanFields(violations: Violation[], part: "model" | "simulation"): Violation[] {
  return violations.map(({ field, description }) => ({ field: field.replace(/^spec(?=\.|$)/, part), description }));
}

/** What is wrong with a field, or with what is in it. */
export function descriptionFor(field: string, violations: Violation[]): string {
  return violations
    .filter(
      (violation) =>
        violation.field === field || violation.field.startsWith(`${field}.`) || violation.field.startsWith(`${field}[`),
    )
    .map(({ field: inner, description }) =>
      inner === field ? description : `${inner.slice(field.length).replace(/^\./, "")} ${description}`,
    )
    .join("; ");
}
