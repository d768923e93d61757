// Keeps the scene as the plan and the run have it.
import { effect, signal, untracked } from "@preact/signals";
import { placedZones, zoneUnderSkin } from "../plan/check";
import { locate, pointOf } from "../plan/landmarks";
import { chart, model, modelMeshes, plan, region, scan, scanMesh, zones } from "../plan/state";
import { liveSite, tool } from "../plan/tools";
import { distance, frame, meshes, planOfRun, runIsOpen, simulation } from "../run/state";
import { beside } from "../run/beside";
import { isFinal, shownShapeOf } from "../shape/state";
import { entryColours, zoneColours, type Rgb } from "../scene/colour_maps";
import type { Delivery } from "@wire/planning_service_pb";
import type { FaceScene } from "../scene/face_scene";
import type { Ball, Line } from "../scene/markers";
import type { Point } from "../scene/surface_geometry";
import { layerShown, showLayers } from "../panels/tissue_panel";
import { delivery, deliveryIsOld } from "../target/state";
import { moved, openGuesses } from "../landmarks/state";
import { faceColours, shownDistances, shownFrame, shownMesh, showsPlanShape } from "./shown";
import { rulerMarks } from "./rulers";
import { section } from "./section_state";
import { compare, quantity, step } from "./stage_state";
import { lookAtFace, lookAtLift, lookAtMissing, lookAtRegion } from "./view_tools";

type End = () => void;

export function bindFace(scene: FaceScene): End {
  let of: string | undefined;
  return effect(() => {
    const mesh = shownMesh.value;
    const isNew = !scene.hasFace || scan.peek()?.name !== of;
    scene.setFace(mesh);
    of = scan.peek()?.name;
    if (isNew && mesh) untracked(() => (chart.value || meshes.value ? lookAtRegion() : lookAtFace("front")));
  });
}

function paintedZone(vertex: number): Rgb | undefined {
  const all = zones.value;
  for (let k = 0; k < all.length; ++k) {
    const { shape } = all[k].zone;
    if (shape.case === "painted" && shape.value.values[vertex] >= 0.5) return zoneColours[k % zoneColours.length];
  }
  return undefined;
}

/** A painted zone as it is in the plan, at once; others as the daemon has placed them. */
function zoneColour(vertex: number): Rgb | undefined {
  const placed = zoneUnderSkin.value[vertex] ?? 0;
  return paintedZone(vertex) ?? (placed >= 1 ? zoneColours[(placed - 1) % zoneColours.length] : undefined);
}

export function bindPatch(scene: FaceScene): End {
  let lookedAt: unknown;
  const patch = effect(() => {
    const onRegion = step.value !== "face" && step.value !== "goal";
    const skin = onRegion ? modelMeshes.value?.get("skin") : undefined;
    const shown = step.value !== "run";
    untracked(() => {
      scene.setPatch(shown ? skin : undefined, zoneColour);
      if (skin && skin !== lookedAt) lookAtRegion();
      if (skin) lookedAt = skin;
    });
  });
  const cover = effect(() => scene.showPatch(!showsPlanShape.value));
  const colours = effect(() => {
    void [zoneUnderSkin.value, zones.value];
    scene.colourPatch(zoneColour);
  });
  const layers = effect(() => {
    const tissue = showLayers.value && step.value === "tissue" ? modelMeshes.value?.get("tissue") : undefined;
    scene.setLayers(
      tissue,
      (model.value?.spec?.layers ?? []).map(({ elementsThrough }) => elementsThrough ?? 1),
      layerShown.value,
    );
  });
  return () => [patch, cover, colours, layers].forEach((end) => end());
}

/** Counts the shapes that marks have to go along with, and their ends. */
const carried = signal(0);

/** The vertex of the face at rest that is nearest to a place. */
function nearestVertex(rest: ArrayLike<number>, at: Point): number {
  let [best, least] = [0, Infinity];
  for (let k = 0; k < rest.length; k += 3) {
    const d = (rest[k] - at[0]) ** 2 + (rest[k + 1] - at[1]) ** 2 + (rest[k + 2] - at[2]) ** 2;
    if (d < least) [best, least] = [k, d];
  }
  return best;
}

/** Marks lie on the skin, not beside it. */
function onSkin(scene: FaceScene, at: Point | undefined): Point | undefined {
  const [rest, points] = [scene.mesh?.points, scene.points];
  if (at === undefined || rest === undefined || points === undefined) return at;
  const k = nearestVertex(rest, at);
  return [points[k], points[k + 1], points[k + 2]];
}

/** A place on the undeformed skin goes as far as the skin does. */
function withSkin(scene: FaceScene, at: Point): Point {
  const [rest, points] = [scene.mesh?.points, scene.points];
  if (!showsPlanShape.peek() || rest === undefined || points === undefined) return at;
  const k = nearestVertex(rest, at);
  return [0, 1, 2].map((c) => at[c] + points[k + c] - rest[k + c]) as Point;
}

const colour: Record<"landmark" | "active" | "corner" | "site" | "ligament" | "wall", Rgb> = {
  landmark: [20, 96, 110],
  active: [230, 120, 0],
  corner: [40, 70, 140],
  site: [190, 30, 60],
  ligament: [110, 60, 140],
  wall: [40, 40, 40],
};

/** Tunnels lie under the skin: they are drawn on it, a ball where the cannula goes in. */
function addDelivery(scene: FaceScene, { entries, passes }: Delivery, balls: Ball[], lines: Line[]): void {
  const colourOf = (entry: number): Rgb => entryColours[entry % entryColours.length];
  const seen = new Set<string>();
  for (const { entry, tunnel, pathMm } of passes) {
    if (seen.has(`${entry} ${tunnel}`)) continue;
    seen.add(`${entry} ${tunnel}`);
    lines.push({ points: pathMm.map((point) => withSkin(scene, pointOf(point))), colour: colourOf(entry) });
  }
  entries.forEach(({ placeMm }, index) => {
    if (placeMm) balls.push({ at: withSkin(scene, pointOf(placeMm)), colour: colourOf(index), radius: 2.2 });
  });
}

export function bindMarkers(scene: FaceScene): End {
  return effect(() => {
    void [scanMesh.value, carried.value];
    const underHand = showsPlanShape.value && !isFinal.value;
    const points = region.value?.landmarksMm ?? {};
    const place = (at: Parameters<typeof locate>[0]): Point | undefined =>
      onSkin(
        scene,
        locate(at, points, region.value?.axes, chart.value && ((xi, eta) => chart.value!.position(xi, eta))),
      );
    const balls: Ball[] = [];
    const lines: Line[] = [];
    const add = (at: Point | undefined, kind: keyof typeof colour, radius = 1.6): void =>
      void (at && balls.push({ at, colour: colour[kind], radius }));
    if (step.value === "face") {
      const active = tool.value.kind === "landmark" ? tool.value.name : "";
      const at = (name: string, place: Point): Point => (moved.value?.name === name ? moved.value.at : place);
      for (const [name, place] of Object.entries(points))
        add(at(name, pointOf(place)), name === active ? "active" : "landmark");
      for (const [name, { at: place }] of Object.entries(openGuesses.value)) add(at(name, place), "active");
    }
    if (step.value === "face" || step.value === "tissue") {
      const corners = (region.value?.corners ?? []).map(place).filter((at) => at !== undefined);
      if (step.value === "tissue") corners.forEach((at) => add(at, "corner"));
      if (corners.length === 4 && modelMeshes.value === undefined && step.value === "tissue")
        lines.push({ points: [...corners, corners[0]], colour: colour.corner });
    }
    // A run of another plan is not on this face.
    const runIsOther = runIsOpen.value && planOfRun.value === "";
    if (step.value === "fat" || (step.value === "run" && !runIsOther)) {
      const { injections = [], ligaments = [], films = [] } = plan.value.simulation ?? {};
      for (const { site } of injections) if (site) add(place(site), "site");
      if (liveSite.value) add(place(liveSite.value), "active");
      if (step.value === "fat") {
        for (const { number, outline } of underHand ? [] : placedZones.value)
          for (const { pointsMm } of outline) {
            const around = pointsMm.map((point) => withSkin(scene, pointOf(point)));
            lines.push({ points: [...around, around[0]], colour: zoneColours[(number - 1) % zoneColours.length] });
          }
        for (const ligament of ligaments)
          if (ligament.place.case === "points")
            ligament.place.value.points.forEach((at) => add(place(at), "ligament", 1.2));
        for (const wall of films.flatMap((film) => film.walls)) {
          if (wall.place.case !== "path") continue;
          const along = wall.place.value.points.map(place).filter((at) => at !== undefined);
          along.forEach((at) => add(at, "wall", 0.9));
          lines.push({ points: along, colour: colour.wall });
        }
        if (delivery.value && !deliveryIsOld.value) addDelivery(scene, delivery.value.list, balls, lines);
      }
    }
    balls.push(...rulerMarks.value.balls);
    lines.push(...rulerMarks.value.lines);
    if (section.value) lines.push({ points: section.value.skin, colour: colour.corner });
    scene.markers.show(balls, lines);
  });
}

/**
 * A frame is worked on once a refresh of the screen, the newest: what came between is only stored.
 */
export function bindFrame(scene: FaceScene): End {
  let due = 0;
  let lookedAt: unknown;
  let shape: unknown;
  const show = (): void => {
    due = 0;
    scene.ownColours = faceColours.value;
    const toGoal = shownDistances.value;
    if (toGoal) {
      scene.showDistances(toGoal.values, toGoal.map);
      return scene.viewport.render();
    }
    scene.show(shownFrame.value, quantity.value);
    const still = showsPlanShape.value && isFinal.value ? shownFrame.value : undefined;
    if (still !== shape) carried.value += 1;
    shape = still;
    // A run that this page has not begun is shown from where it moves most.
    const own = model.peek() !== undefined && simulation.peek()?.spec?.model === model.peek()!.name;
    if (frame.value && !shownShapeOf.value && scene.mesh !== lookedAt && !own && scene.lift > 0.2) {
      lookedAt = scene.mesh;
      lookAtLift();
    }
    scene.viewport.render(); // in this refresh, not the next
  };
  let measured: unknown;
  const look = effect(() => {
    const toGoal = shownDistances.value;
    if (toGoal === undefined || toGoal.values === measured) return;
    measured = toGoal.values;
    untracked(lookAtMissing);
  });
  const end = effect(() => {
    void [beside.value, compare.value, shownFrame.value, quantity.value, shownMesh.value, shownDistances.value];
    void faceColours.value;
    if (shownDistances.value === undefined) scene.forgetDistance();
    if (distance.value) scene.setDistance(distance.value.vertices, distance.value.distanceMm);
    if (due === 0) due = requestAnimationFrame(show);
  });
  return () => {
    cancelAnimationFrame(due);
    look();
    end();
  };
}
