// How many different frames become pictures, and fewer pixels where a machine is too slow to show
// them all.
import { frame, store } from "../run/state";
import type { FaceScene } from "../scene/face_scene";
import { rate } from "./stage_state";

const lookEveryMs = 500;
/** Below this the skin no longer seems to move. */
const fluent = 24;
const coarse = 0.5;

/** @param element  tells the count as data-pictures */
export function countPictures(scene: FaceScene, element: HTMLElement): () => void {
  let [shown, last, total, since] = [0, frame.value, 0, performance.now()];
  let arrivedBefore = store.arrived;
  scene.viewport.onRendered = () => {
    if (frame.value === last || frame.value === undefined) return;
    last = frame.value;
    shown += 1;
    element.dataset.pictures = String((total += 1));
  };
  const timer = setInterval(() => {
    const now = performance.now();
    rate.value = (1000 * shown) / (now - since);
    const came = (1000 * (store.arrived - arrivedBefore)) / (now - since);
    if (came === 0) scene.viewport.detail = 1;
    else if (rate.value < fluent && came > 1.3 * rate.value) scene.viewport.detail = coarse;
    [shown, since, arrivedBefore] = [0, now, store.arrived];
  }, lookEveryMs);
  return () => clearInterval(timer);
}
