// What the picture is of: a shape that was asked for, else the run, else the face.
import { computed } from "@preact/signals";
import { modelMeshes, plan, scanMesh } from "../plan/state";
import { faceMesh, frame, meshes } from "../run/state";
import { shownForecast } from "../forecast/state";
import { shapeFrame, shownShapeOf } from "../shape/state";
import { distanceMap, distances, goalView, targetMesh } from "../target/state";
import { ownColours, step } from "./stage_state";

const planFace = computed(() =>
  plan.value.model?.geometry.case === "square" ? modelMeshes.value?.get("skin") : undefined,
);
const showsShape = computed(() => shownShapeOf.value !== undefined && shapeFrame.value !== undefined);
/** What the zones are painted on would hide it. */
export const showsPlanShape = computed(() => showsShape.value && shownShapeOf.value === "plan");

/**
 * The run is seen where runs are: elsewhere places are set on the face as it was scanned. The face
 * is the scan, else the skin of a plate.
 */
export const shownMesh = computed(() => {
  const face = scanMesh.value ?? planFace.value;
  if (step.value === "goal" && goalView.value === "target") return targetMesh.value ?? face;
  if (step.value !== "run" || showsPlanShape.value) return planFace.value ?? face;
  return meshes.value?.get(faceMesh.value) ?? face;
});
/** Colours as they were scanned of what is shown: a run's face has them where it is the scan. */
export const scanColours = computed(() => {
  const [mesh, of] = [shownMesh.value, scanMesh.value];
  if (mesh?.colours !== undefined) return mesh.colours;
  const isScan = mesh !== undefined && mesh.points.length === of?.points.length;
  return isScan && mesh.points.every((value, k) => value === of.points[k]) ? of.colours : undefined;
});
export const faceColours = computed(() => (ownColours.value ? scanColours.value : undefined));
export const shownFrame = computed(() =>
  shownForecast.value
    ? undefined
    : showsShape.value
      ? shapeFrame.value
      : step.value === "run"
        ? frame.value
        : undefined,
);
export const showsFrame = computed(() => shownFrame.value !== undefined && shownMesh.value !== undefined);

/** Signed distances to the goal, a vertex of the face, and their colours. */
export const shownDistances = computed(() =>
  step.value === "goal" && goalView.value === "missing" && distances.value && distanceMap.value
    ? { values: distances.value, map: distanceMap.value }
    : undefined,
);
