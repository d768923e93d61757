// What somebody else changed in the plan, in words.
import type { JsonValue } from "@bufbuild/protobuf";
import type { Plan } from "@wire/plan_pb";
import { readable } from "../plan/anatomy";
import { fieldWords } from "../plan/field_words";
import type { Change, Merge } from "./merge";

const mostNamed = 3;
const units: [RegExp, string][] = [
  [/_ml_per_s$/, "mL/s"],
  [/_ml$/, "mL"],
  [/_mm$/, "mm"],
  [/_kpa$/, "kPa"],
  [/_s$/, "s"],
];

function valueWords(field: string, value: JsonValue | undefined): string {
  if (typeof value === "number" || typeof value === "boolean") {
    const unit = units.find(([ending]) => ending.test(field))?.[1] ?? "";
    return `${value} ${unit}`.trim();
  }
  return typeof value === "string" ? readable(value) : "";
}

/** "Volume of injection 1 (1 mL → 2 mL)" */
function changeWords({ field, before, after }: Change, plan: Plan): string {
  const what = field === "name" ? "Name" : fieldWords(field, plan);
  const [from, to] = [valueWords(field, before), valueWords(field, after)];
  return from === "" && to === "" ? what : `${what} (${from || "none"} → ${to || "none"})`;
}

function list(changes: Change[], plan: Plan): string {
  const words = [...new Set(changes.map((change) => changeWords(change, plan)))];
  const more = words.length - mostNamed;
  return words.slice(0, mostNamed).join(", ") + (more > 0 ? ` and ${more} more` : "");
}

/** What the page says after it took over what others changed; empty where there is nothing. */
export function mergeWords({ plan, theirs, lost }: Merge, at: Date): string {
  if (theirs.length === 0) return "";
  const time = at.toLocaleTimeString("en-GB", { hour: "2-digit", minute: "2-digit" });
  const changed = `Changed elsewhere at ${time}: ${list(theirs, plan)}.`;
  if (lost.length === 0) return changed;
  const mine = lost.map(({ field, after }) => [fieldWords(field, plan), valueWords(field, after)] as const);
  const values = mine.map(([what, value]) => (value === "" ? what : `${what} ${value}`)).slice(0, mostNamed);
  return `${changed} Yours came later and was not taken: ${values.join(", ")}.`;
}
