// What is in each zone, and how it presses.
import type { ZoneSummary } from "@wire/simulation_pb";
import { readable } from "../plan/anatomy";
import { mmHgPerPa } from "../scene/colour_maps";

export function ZoneTable({ zones }: { zones: ZoneSummary[] }) {
  return (
    <table class="figures-table">
      <thead>
        <tr>
          <th>Zone</th>
          <th>mL</th>
          <th>mmHg</th>
          <th>mm</th>
        </tr>
      </thead>
      <tbody>
        {zones.map((zone) => (
          <tr key={zone.name}>
            <th>{readable(zone.name)}</th>
            <td>{zone.volumeMl.toFixed(2)}</td>
            <td>{(zone.meanPressurePa * mmHgPerPa).toFixed(1)}</td>
            <td>{zone.maxThicknessMm.toFixed(1)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
