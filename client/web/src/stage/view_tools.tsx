// Buttons on the picture: where to look from, what is coloured, before and after, rulers, sections.
import { signal } from "@preact/signals";
import { midline } from "../plan/anatomy";
import { axesOf, pointOf } from "../plan/landmarks";
import { chart, modelMeshes, plan, region } from "../plan/state";
import { tool } from "../plan/tools";
import { beside, listOthers, othersOfFace, putBeside, titleOf } from "../run/beside";
import { distance, hasResult, recorded, runAxes } from "../run/state";
import { shownShapeOf } from "../shape/state";
import type { Point } from "../scene/surface_geometry";
import { contralateral, faceView, middleOf, regionView, type StandardView } from "../scene/views";
import { lookAs, lookFrom, showFrom } from "./camera";
import { canCut, showSection } from "./section_state";
import { scanColours, shownDistances, shownMesh, showsFrame } from "./shown";
import {
  compare,
  dark,
  ownColours,
  presenting,
  quantity,
  showRulers,
  shownScene,
  step,
  type Compare,
} from "./stage_state";
import { Segmented } from "../widgets/fields";
import type { Quantity } from "../scene/colour_maps";
import { ForecastTools } from "./forecast_tools";
import { NearTools } from "./near_tools";

/** The buttons wait behind one where the picture is narrow. */
const isOpen = signal(false);

const axes = () => runAxes.value ?? axesOf(region.value?.landmarksMm ?? {}, region.value?.axes);

/** The page's own look at a face that is new. */
export function lookAtFace(which: StandardView): void {
  const mesh = shownScene.value?.mesh;
  if (mesh) showFrom(faceView(mesh, axes(), which));
}

function lookFromStandard(which: StandardView): void {
  const mesh = shownScene.value?.mesh;
  if (mesh) lookFrom(faceView(mesh, axes(), which));
}

/** A point of the plane between both sides. */
function middle(): Point | undefined {
  const points = region.value?.landmarksMm ?? {};
  const known = midline.filter((name) => points[name]).map((name) => pointOf(points[name]));
  const mesh = shownScene.value?.mesh;
  if (known.length === 0) return mesh && middleOf(mesh);
  return [0, 1, 2].map((c) => known.reduce((sum, p) => sum + p[c], 0) / known.length) as Point;
}

function lookAtOtherSide(): void {
  const [pose, at] = [shownScene.value?.viewport.pose, middle()];
  if (pose && at) lookAs(contralateral(pose, at, axes().left));
}

/** Where the skin has moved. */
export function lookAtLift(show = showFrom): void {
  const view = shownScene.value?.liftView(axes());
  if (view) show(view);
}

/** Where most is missing to the goal. */
export function lookAtMissing(show = showFrom): void {
  const toGoal = shownDistances.value;
  const view = toGoal && shownScene.value?.missingView(toGoal.values, axes());
  if (view) show(view);
}

export function lookAtRegion(show = showFrom): void {
  const skin = modelMeshes.value?.get("skin");
  const flat = skin !== undefined && plan.value.model?.geometry.case === "square";
  if (skin && chart.value) show(regionView(skin, axes(), flat));
  else lookAtFace("left_oblique");
}

const views: { view: StandardView; label: string; title: string }[] = [
  { view: "right", label: "Right", title: "Right profile" },
  { view: "right_oblique", label: "Right ¾", title: "Right ¾, oblique" },
  { view: "front", label: "Front", title: "Front" },
  { view: "left_oblique", label: "Left ¾", title: "Left ¾, oblique" },
  { view: "left", label: "Left", title: "Left profile" },
];

function CompareTools() {
  return (
    <div class="row wrap compare-tools">
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
      {compare.value !== "after" && recorded.value === "" && (
        <select
          class="beside"
          aria-label="Compared with"
          value={beside.value?.name ?? ""}
          onFocus={() => void listOthers()}
          onPointerEnter={() => void listOthers()}
          onChange={(event) => void putBeside(event.currentTarget.value)}
        >
          <option value="">The face before</option>
          {othersOfFace.value.map((other) => (
            <option key={other.name} value={other.name}>
              {titleOf(other)}
            </option>
          ))}
        </select>
      )}
    </div>
  );
}

function More() {
  return (
    <div class="row wrap">
      <button
        type="button"
        class="button small"
        aria-pressed={showRulers.value}
        onClick={() => {
          showRulers.value = !showRulers.value;
          if (!showRulers.value && tool.value.kind === "measure") tool.value = { kind: "turn" };
        }}
      >
        Measure
      </button>
      {hasResult.value && step.value === "run" && canCut.value && (
        <button
          type="button"
          class="button small"
          aria-pressed={showSection.value}
          onClick={() => (showSection.value = !showSection.value)}
        >
          Section
        </button>
      )}
      {scanColours.value && (
        <button
          type="button"
          class="button small"
          aria-pressed={ownColours.value}
          title="The face in the colours it was scanned in"
          onClick={() => (ownColours.value = !ownColours.value)}
        >
          Scanned colours
        </button>
      )}
      <button
        type="button"
        class="button small"
        aria-pressed={presenting.value}
        title="The face without forms; Esc ends it"
        onClick={() => (presenting.value = !presenting.value)}
      >
        Present
      </button>
      {presenting.value && (
        <button
          type="button"
          class="button small"
          aria-pressed={dark.value}
          title="Dark around the face, for a dim room"
          onClick={() => (dark.value = !dark.value)}
        >
          Dark
        </button>
      )}
    </div>
  );
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
    <div class={`view-tools ${isOpen.value ? "open" : ""}`}>
      <button
        type="button"
        class="button small tools-key"
        aria-expanded={isOpen.value}
        onClick={() => (isOpen.value = !isOpen.value)}
      >
        {isOpen.value ? "Back to the picture" : "View…"}
      </button>
      <div class="row wrap" role="group" aria-label="Look from">
        {views.map(({ view, label, title }) => (
          <button
            type="button"
            key={view}
            class="button small"
            aria-label={title}
            title={title}
            onClick={() => lookFromStandard(view)}
          >
            {label}
          </button>
        ))}
        <button type="button" class="button small" title="This view of the other side" onClick={lookAtOtherSide}>
          Other side
        </button>
        {shownDistances.value && (
          <button type="button" class="button small" onClick={() => lookAtMissing(lookFrom)}>
            Missing
          </button>
        )}
        {chart.value && (
          <button type="button" class="button small" onClick={() => lookAtRegion(lookFrom)}>
            Region
          </button>
        )}
      </div>
      <NearTools />
      {showsFrame.value && (step.value === "run" || shownShapeOf.value) && (
        <Segmented
          label="Colour by"
          value={quantity.value}
          options={colours}
          onChange={(value) => (quantity.value = value)}
        />
      )}
      <ForecastTools />
      {hasResult.value && step.value === "run" && <CompareTools />}
      <More />
    </div>
  );
}
