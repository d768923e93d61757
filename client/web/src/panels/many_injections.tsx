// Plans that lay fat pass by pass have too many injections for a form each: what goes into each
// zone.
import type { Injection } from "@wire/simulation_pb";
import { readable } from "../plan/anatomy";

/** More injections than these are shown by zone. */
export const mostShown = 12;

export function Many({ injections }: { injections: Injection[] }) {
  const byZone = new Map<string, { passes: number; volumeMl: number }>();
  for (const { zone, volumeMl } of injections) {
    const { passes, volumeMl: before } = byZone.get(zone) ?? { passes: 0, volumeMl: 0 };
    byZone.set(zone, { passes: passes + 1, volumeMl: before + (volumeMl ?? 0) });
  }
  return (
    <>
      <table class="figures-table">
        <thead>
          <tr>
            <th scope="col">Zone</th>
            <th scope="col">passes</th>
            <th scope="col">mL</th>
          </tr>
        </thead>
        <tbody>
          {[...byZone].map(([zone, { passes, volumeMl }]) => (
            <tr key={zone}>
              <th scope="row">{readable(zone)}</th>
              <td>{passes}</td>
              <td>{volumeMl.toFixed(2)}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p class="hint">This plan lays fat pass by pass. Undo it to change the volumes of zones.</p>
    </>
  );
}
