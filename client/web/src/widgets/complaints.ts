// What the daemon has against the fields of the form, each said at one place.
import { computed, signal } from "@preact/signals";
import { useLayoutEffect } from "preact/hooks";
import { plan, violations } from "../plan/state";
import { descriptionFor, elsewhere } from "../plan/violations";
import { refusals } from "../run/state";

/** Fields that the form has now, and how often. */
const shown = signal<ReadonlyMap<string, number>>(new Map());

function count(field: string, by: 1 | -1): void {
  const next = new Map(shown.peek());
  const left = (next.get(field) ?? 0) + by;
  if (left > 0) next.set(field, left);
  else next.delete(field);
  shown.value = next;
}

/** The form has this field as long as the component is there. */
export function useFieldOfForm(field: string | undefined): void {
  useLayoutEffect(() => {
    if (field === undefined) return;
    count(field, 1);
    return () => count(field, -1);
  }, [field]);
}

const all = computed(() => [...violations.value, ...refusals.value]);

export const complaintOf = (field: string | undefined): string =>
  field === undefined || all.value.length === 0 ? "" : descriptionFor(field, all.value, shown.value.keys(), plan.value);

/** What no field of this step says. */
export const complaintsElsewhere = computed(() => elsewhere(all.value, shown.value.keys(), plan.value));
/** Whether a field of this step says something. */
export const complaintsHere = computed(() => all.value.length > complaintsElsewhere.value.length);
