// What the picture is of: a shape that was asked for, else the run, else the face.
import { computed } from "@preact/signals";
import { modelMeshes, plan, scanMesh } from "../plan/state";
import { faceMesh, frame, meshes } from "../run/state";
import { shapeFrame, shownShapeOf } from "../shape/state";

const planFace = computed(() =>
  plan.value.model?.geometry.case === "square" ? modelMeshes.value?.get("skin") : undefined,
);
const showsShape = computed(() => shownShapeOf.value !== undefined && shapeFrame.value !== undefined);
/** What the zones are painted on would hide it. */
export const showsPlanShape = computed(() => showsShape.value && shownShapeOf.value === "plan");

/** The face is the run's where there is one, else the scan, else the skin of a plate. */
export const shownMesh = computed(() => {
  if (showsPlanShape.value) return planFace.value ?? scanMesh.value;
  return meshes.value?.get(faceMesh.value) ?? scanMesh.value ?? planFace.value;
});
export const shownFrame = computed(() => (showsShape.value ? shapeFrame.value : frame.value));
export const showsFrame = computed(() => shownFrame.value !== undefined && shownMesh.value !== undefined);
