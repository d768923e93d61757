// How many different frames become pictures, and fewer pixels where a machine is too slow to show
// them all.
import { store } from "../run/state";
import type { FaceScene } from "../scene/face_scene";
import { isFinal, shownShapeOf } from "../shape/state";
import { shownFrame } from "./shown";
import { rate } from "./stage_state";

const lookEveryMs = 500;
/** Below this the skin no longer seems to move. */
const fluent = 24;
const coarse = 0.5;

/** @param element  tells the count as data-pictures */
export function countPictures(scene: FaceScene, element: HTMLElement): () => void {
  let [shown, last, total, since] = [0, shownFrame.value, 0, performance.now()];
  let arrivedBefore = store.arrived;
  // Shapes are asked for one after the other: what drawing takes, they wait for.
  const following = (): boolean => shownShapeOf.value !== undefined && !isFinal.value;
  scene.viewport.onRendered = () => {
    if (shownFrame.value === last || shownFrame.value === undefined) return;
    last = shownFrame.value;
    shown += 1;
    element.dataset.pictures = String((total += 1));
  };
  const timer = setInterval(() => {
    const now = performance.now();
    rate.value = (1000 * shown) / (now - since);
    const came = (1000 * (store.arrived - arrivedBefore)) / (now - since);
    const slow = rate.value < fluent;
    if (following()) {
      if (shown > 0 && slow) scene.detail = coarse;
    } else if (came === 0) scene.detail = 1;
    else if (slow && came > 1.3 * rate.value) scene.detail = coarse;
    [shown, since, arrivedBefore] = [0, now, store.arrived];
  }, lookEveryMs);
  return () => clearInterval(timer);
}
