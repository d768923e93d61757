// Nearer, farther, around: what two fingers, a wheel or a drag do, by one press each.
import type { Viewport } from "../scene/viewport";
import { moveCamera } from "./camera";

const nearer = 1.25;
const turnDegrees = 15;

const presses: { label: string; sign: string; move: (viewport: Viewport) => void }[] = [
  { label: "Nearer", sign: "+", move: (viewport) => viewport.approach(nearer) },
  { label: "Farther", sign: "−", move: (viewport) => viewport.approach(1 / nearer) },
  { label: "Turn to the left", sign: "↶", move: (viewport) => viewport.turn(turnDegrees, 0) },
  { label: "Turn to the right", sign: "↷", move: (viewport) => viewport.turn(-turnDegrees, 0) },
];

export function NearTools() {
  return (
    <div class="row" role="group" aria-label="Move the view">
      {presses.map(({ label, sign, move }) => (
        <button
          type="button"
          key={label}
          class="button small"
          aria-label={label}
          title={label}
          onClick={() => moveCamera(move)}
        >
          {sign}
        </button>
      ))}
    </div>
  );
}
