// Buttons on the picture: where to look from, what is coloured, before and after.
import { axesOf } from "../plan/landmarks";
import { chart, modelMeshes, plan, region } from "../plan/state";
import { distance, hasResult, runAxes } from "../run/state";
import { shownShapeOf } from "../shape/state";
import { faceView, regionView, type View } from "../scene/views";
import { shownDistances, shownMesh, showsFrame } from "./shown";
import { compare, quantity, shownScene, step, type Compare } from "./stage_state";
import { Segmented } from "../widgets/fields";
import type { Quantity } from "../scene/colour_maps";

function look(view: View): void {
  shownScene.value?.viewport.lookAt(view.focus, view.direction, view.up, view.halfHeight);
}
const axes = () => runAxes.value ?? axesOf(region.value?.landmarksMm ?? {}, region.value?.axes);

export function lookAtFace(turn: "front" | "left" | "right"): void {
  const mesh = shownScene.value?.mesh;
  if (mesh) look(faceView(mesh, axes(), turn));
}

/** Where the skin has moved. */
export function lookAtLift(): void {
  const view = shownScene.value?.liftView(axes());
  if (view) look(view);
}

/** Where most is missing to the goal. */
export function lookAtMissing(): void {
  const toGoal = shownDistances.value;
  const view = toGoal && shownScene.value?.missingView(toGoal.values, axes());
  if (view) look(view);
}

export function lookAtRegion(): void {
  const skin = modelMeshes.value?.get("skin");
  const flat = skin !== undefined && plan.value.model?.geometry.case === "square";
  if (skin && chart.value) look(regionView(skin, axes(), flat));
  else lookAtFace("left");
}

export function ViewTools() {
  const colours: { value: Quantity | "none"; label: string }[] = [
    { value: "displacement", label: "Displacement" },
    { value: "pressure", label: "Pressure" },
    { value: "thickness", label: "Fat" },
    ...(distance.value ? [{ value: "distance" as const, label: "Goal" }] : []),
    { value: "none", label: "Skin" },
  ];
  if (!shownMesh.value) return null;
  return (
    <div class="view-tools">
      <div class="row">
        <button type="button" class="button small" onClick={() => lookAtFace("right")}>
          Right
        </button>
        <button type="button" class="button small" onClick={() => lookAtFace("front")}>
          Front
        </button>
        <button type="button" class="button small" onClick={() => lookAtFace("left")}>
          Left
        </button>
        {shownDistances.value && (
          <button type="button" class="button small" onClick={lookAtMissing}>
            Missing
          </button>
        )}
        {chart.value && (
          <button type="button" class="button small" onClick={lookAtRegion}>
            Region
          </button>
        )}
      </div>
      {showsFrame.value && (step.value === "run" || shownShapeOf.value) && (
        <Segmented
          label="Colour by"
          value={quantity.value}
          options={colours}
          onChange={(value) => (quantity.value = value)}
        />
      )}
      {hasResult.value && step.value === "run" && (
        <Segmented<Compare>
          label="Compare"
          value={compare.value}
          onChange={(value) => (compare.value = value)}
          options={[
            { value: "after", label: "After" },
            { value: "side", label: "Side by side" },
            { value: "slider", label: "Slider" },
          ]}
        />
      )}
    </div>
  );
}
