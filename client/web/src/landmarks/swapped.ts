// Landmarks whose sides are taken for each other: the commonest mistake, as left is the patient's.
import type { Vector3 } from "@wire/geometry_pb";
import { pointOf } from "../plan/landmarks";
import type { Point } from "../scene/surface_geometry";
import { along, cross, dot } from "./head_frame";

const sidesOf = (name: string): [string, string] => [`${name}_left`, `${name}_right`];

/** Names of paired landmarks that are both there, without their side. */
function pairsOf(points: Record<string, Vector3>): string[] {
  return Object.keys(points)
    .filter((name) => name.endsWith("_left"))
    .map((name) => name.slice(0, -"_left".length))
    .filter((name) => points[`${name}_right`] !== undefined);
}

/**
 * Pairs whose left is on the right: the tip of the nose says where forwards is, nasion and chin
 * where upwards is. Without these three nothing is said.
 */
export function swappedPairs(points: Record<string, Vector3>): string[] {
  const at = (name: string): Point | undefined => (points[name] ? pointOf(points[name]) : undefined);
  const [nasion, tip, chin] = [at("nasion"), at("pronasale"), at("subnasale") ?? at("pogonion") ?? at("menton")];
  if (!nasion || !tip || !chin) return [];
  const up = along(nasion, -1, chin);
  const forward = along(tip, -1, along(chin, 0.5, up));
  const left = cross(up, forward);
  return pairsOf(points).filter((name) => {
    const [one, other] = sidesOf(name);
    return dot(along(at(one)!, -1, at(other)!), left) < 0;
  });
}

/** Gives the landmarks of pairs the names of the other side. */
export function swap(points: Record<string, Vector3>, pairs: string[]): void {
  for (const name of pairs) {
    const [left, right] = sidesOf(name);
    [points[left], points[right]] = [points[right], points[left]];
  }
}
