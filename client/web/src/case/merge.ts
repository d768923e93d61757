// Two edits of one plan: what each changed, put together field by field.
import { fromJson, toJson, type JsonValue } from "@bufbuild/protobuf";
import { PlanSchema, type Plan } from "@wire/plan_pb";

/** A field, and what it was before and is after; undefined where it is absent. */
export interface Change {
  /** as in the schema, "simulation.injections[0].volume_ml" */
  field: string;
  before: JsonValue | undefined;
  after: JsonValue | undefined;
}

export interface Merge {
  plan: Plan;
  /** what the others changed */
  theirs: Change[];
  /** what both changed, to different things: theirs stands, and `after` is what ours was */
  lost: Change[];
}

type Json = JsonValue | undefined;
type Tree = Record<string, JsonValue>;

const isTree = (value: Json): value is Tree => typeof value === "object" && value !== null && !Array.isArray(value);
const isEqual = (one: Json, other: Json): boolean => {
  if (one === other) return true;
  if (Array.isArray(one) && Array.isArray(other))
    return one.length === other.length && one.every((value, k) => isEqual(value, other[k]));
  if (!isTree(one) || !isTree(other)) return false;
  const keys = Object.keys(one);
  return keys.length === Object.keys(other).length && keys.every((key) => isEqual(one[key], other[key]));
};

const below = (path: string, key: string | number): string =>
  typeof key === "number" ? `${path}[${key}]` : path === "" ? key : `${path}.${key}`;

/** The parts of values that merge one by one: fields, or elements of lists of one length. */
function partsOf(values: Json[]): (string | number)[] | undefined {
  if (values.every(isTree)) return [...new Set(values.flatMap((value) => Object.keys(value)))];
  const lists = values.filter((value): value is JsonValue[] => Array.isArray(value));
  const fits =
    lists.length === values.length && lists.every((list) => list.length === lists[0].length && list.every(isTree));
  return fits ? lists[0].map((_, k) => k) : undefined;
}

const partOf = (value: Json, key: string | number): Json => (value as Record<string | number, Json>)[key];

function changesAt(path: string, before: Json, after: Json, into: Change[]): void {
  if (isEqual(before, after)) return;
  const parts = partsOf([before, after]);
  if (parts === undefined) into.push({ field: path, before, after });
  else parts.forEach((key) => changesAt(below(path, key), partOf(before, key), partOf(after, key), into));
}

function mergeAt(path: string, base: Json, ours: Json, theirs: Json, lost: Change[]): Json {
  // What is equal stays ours: maps come from the daemon in any order, which would read as a change.
  if (isEqual(ours, theirs)) return ours;
  const parts = partsOf([base, ours, theirs]);
  if (parts === undefined) {
    if (isEqual(theirs, base)) return ours;
    if (!isEqual(ours, base)) lost.push({ field: path, before: theirs, after: ours });
    return theirs;
  }
  const merged = parts.map(
    (key) => [key, mergeAt(below(path, key), partOf(base, key), partOf(ours, key), partOf(theirs, key), lost)] as const,
  );
  if (Array.isArray(theirs)) return merged.map(([, value]) => value!);
  return Object.fromEntries(merged.filter(([, value]) => value !== undefined)) as Tree;
}

const jsonOf = (plan: Plan): JsonValue => toJson(PlanSchema, plan, { useProtoFieldName: true });

/** The fields in which a plan differs from what it was. */
export function changesOf(before: Plan, after: Plan): Change[] {
  const changes: Change[] = [];
  changesAt("", jsonOf(before), jsonOf(after), changes);
  return changes;
}

/**
 * What two made of one plan, in one: each has what the other changed. Where both changed one field,
 * theirs stands, who were first.
 */
export function mergePlans(base: Plan, ours: Plan, theirs: Plan): Merge {
  const lost: Change[] = [];
  const merged = mergeAt("", jsonOf(base), jsonOf(ours), jsonOf(theirs), lost);
  return { plan: fromJson(PlanSchema, merged!), theirs: changesOf(base, theirs), lost };
}
