// Where the face is looked at from: by the hand that turns it, by the page where it shows something
// new, and by an address that is opened.
import { effect, signal } from "@preact/signals";
import { scan } from "../plan/state";
import type { View } from "../scene/views";
import type { CameraPose, Viewport } from "../scene/viewport";
import { lookedAt } from "../run/state";
import { shownScene } from "./stage_state";

const settledMs = 400;

/** as somebody has turned it; undefined: as the page looks at what it shows */
export const camera = signal<CameraPose | undefined>(undefined);
/** The same, and the moment that is looked at [s], once they have stood still. */
export const stillCamera = signal<CameraPose | undefined>(undefined);
export const stillMoment = signal<number | undefined>(undefined);

/** what an address wants, until the face that it is of has come and somebody does something */
let held: { pose: CameraPose; scan: string } | undefined;

function place(pose: CameraPose): void {
  const viewport = shownScene.peek()?.viewport;
  if (viewport) viewport.placed = pose;
  camera.value = pose;
}

/** The page is to look at a scan as an address has it. */
export function holdCamera(pose: CameraPose | undefined, of: string): void {
  held = pose && { pose, scan: of };
  if (pose && shownScene.peek()?.hasFace === true && (scan.peek()?.name ?? "") === of) place(pose);
  else if (pose === undefined) camera.value = undefined;
}

/** The page's own view of something new; an address that wants another one has its way. */
export function showFrom({ focus, direction, up, halfHeight }: View): void {
  if (held?.scan === (scan.peek()?.name ?? "")) return place(held.pose);
  camera.value = undefined;
  shownScene.peek()?.viewport.lookAt(focus, direction, up, halfHeight);
}

/** A view that somebody asked for. */
export function lookFrom({ focus, direction, up, halfHeight }: View): void {
  held = undefined;
  const viewport = shownScene.peek()?.viewport;
  viewport?.lookAt(focus, direction, up, halfHeight);
  camera.value = viewport?.pose;
}

export function lookAs(pose: CameraPose): void {
  held = undefined;
  place(pose);
}

/** A turn or a step by one press, also where it leads back to the page's own view. */
export function moveCamera(move: (viewport: Viewport) => void): void {
  held = undefined;
  const viewport = shownScene.peek()?.viewport;
  if (viewport) move(viewport);
  camera.value = viewport?.pose;
}

/** From the start of the picture to its end. */
export function bindCamera(): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const scene = shownScene.peek()!;
  scene.viewport.onTurned = (pose) => (camera.value = pose);
  const release = (): void => void (held = undefined);
  const kinds = ["pointerdown", "wheel", "keydown"] as const;
  kinds.forEach((kind) => window.addEventListener(kind, release, true));
  const end = effect(() => {
    const [pose, moment] = [camera.value, lookedAt.value];
    clearTimeout(timer);
    timer = setTimeout(() => ([stillCamera.value, stillMoment.value] = [pose, moment]), settledMs);
  });
  return () => {
    end();
    clearTimeout(timer);
    kinds.forEach((kind) => window.removeEventListener(kind, release, true));
  };
}
