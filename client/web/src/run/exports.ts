// What a person takes home: plan, figures, picture, surface.
import { Simulation_State, type Simulation } from "@wire/simulation_pb";

export function save(fileName: string, content: string | Blob): void {
  const url = URL.createObjectURL(typeof content === "string" ? new Blob([content], { type: "text/plain" }) : content);
  const link = document.createElement("a");
  Object.assign(link, { href: url, download: fileName });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/** The surface as it is now, in millimetres, in the frame of the scan. */
export function surfaceObj(points: ArrayLike<number>, cells: Uint32Array, corners: number): string {
  const lines = ["# Lipofill: simulated skin, millimetres. Research and planning aid, not a medical device."];
  for (let k = 0; k < points.length; k += 3)
    lines.push(`v ${points[k].toFixed(4)} ${points[k + 1].toFixed(4)} ${points[k + 2].toFixed(4)}`);
  for (let k = 0; k < cells.length; k += corners)
    lines.push(`f ${Array.from(cells.subarray(k, k + corners), (index) => index + 1).join(" ")}`);
  return `${lines.join("\n")}\n`;
}

/** "Running", "Queued (2)". */
export function stateWord(simulation: Simulation | undefined): string {
  if (!simulation || simulation.state === Simulation_State.STATE_UNSPECIFIED) return "";
  const name = Simulation_State[simulation.state] ?? "Unknown";
  const word = name.charAt(0) + name.slice(1).toLowerCase();
  return simulation.state === Simulation_State.QUEUED && simulation.queuePosition > 0
    ? `${word} (${simulation.queuePosition})`
    : word;
}

/** Of a state, for the style sheet. */
export function stateClass(simulation: Simulation | undefined): string {
  return `state-${stateWord(simulation).split(" ")[0].toLowerCase() || "none"}`;
}
