// Small pictures of many simulations, one after the other: a stream is opened for a frame and left
// again, so that a wall of them takes one connection and one canvas.
import { Simulation_State, type Simulation } from "@wire/simulation_pb";
import { toNumbers } from "../api/arrays";
import { lastFrame } from "../api/last_frame";
import type { Mesh } from "../api/meshes";
import { mapFor, paint, skinColour } from "../scene/colour_maps";
import { largestOf } from "../scene/face_colours";
import { viewOf } from "../scene/outside_view";
import { Surface } from "../scene/surface";
import { Faces } from "./faces";
import { Viewport } from "../scene/viewport";

const [width, height] = [320, 240];
const pauseMs = 250;
/** How much is seen around what moves, so that one knows whose face it is. */
const around = 2.3;
/** What moves is drawn so far outside the face, where both would be at one place [mm]. */
const overFaceMm = 0.35;
/** So that little looks like little. */
const leastScaleMm = 3;

export class Thumbnails {
  private readonly holder = document.createElement("div");
  private readonly viewport: Viewport;
  private readonly leave = new AbortController();
  private wanted: Simulation[] = [];
  /** step that the picture of a simulation shows */
  private readonly shown = new Map<string, bigint>();
  private readonly urls = new Map<string, string>();
  private next = 0;
  private readonly faces = new Faces();

  constructor(private readonly done: (name: string, url: string) => void) {
    Object.assign(this.holder.style, {
      position: "fixed",
      left: "-2000px",
      top: "0",
      width: `${width}px`,
      height: `${height}px`,
    });
    document.body.append(this.holder);
    this.viewport = new Viewport(this.holder);
    void this.turn();
  }

  want(simulations: Simulation[]): void {
    this.wanted = simulations;
    const names = new Set(simulations.map(({ name }) => name));
    for (const [name, url] of this.urls) {
      if (names.has(name)) continue;
      URL.revokeObjectURL(url);
      this.urls.delete(name);
    }
  }

  private async turn(): Promise<void> {
    while (!this.leave.signal.aborted) {
      const due = this.choose();
      if (due) await this.picture(due).catch(() => this.shown.set(due.name, due.summary?.steps ?? 0n));
      await new Promise((resolve) => setTimeout(resolve, pauseMs));
    }
  }

  /** The next in the round whose picture is not of its step. */
  private choose(): Simulation | undefined {
    for (let k = 0; k < this.wanted.length; ++k) {
      const one = this.wanted[(this.next + k) % this.wanted.length];
      // To look at one that is parked would wake it.
      if (
        one.state === Simulation_State.FAILED ||
        one.parked ||
        this.shown.get(one.name) === (one.summary?.steps ?? 0n)
      )
        continue;
      this.next = (this.next + k + 1) % this.wanted.length;
      return one;
    }
    return undefined;
  }

  private async picture(simulation: Simulation): Promise<void> {
    const step = simulation.summary?.steps ?? 0n;
    const { mesh, displacement } = await this.fetch(simulation.name);
    const surface = new Surface(mesh);
    surface.move(displacement);
    colour(surface, displacement);
    const face = await this.faces.of(simulation.spec?.model ?? "");
    if (face) {
      for (let k = 0; k < surface.points.length; ++k) surface.points[k] += overFaceMm * surface.normals[k];
      surface.moved();
      this.viewport.add(face.actor);
    }
    this.viewport.add(surface.actor);
    const { focus, direction, up, halfHeight } = viewOf(surface);
    this.viewport.lookAt(focus, direction, up, (face ? around : 1) * halfHeight);
    const picture = await this.viewport.capture();
    this.viewport.remove(surface.actor);
    if (face) this.viewport.remove(face.actor);
    surface.dispose();
    const before = this.urls.get(simulation.name);
    if (before) URL.revokeObjectURL(before);
    const url = URL.createObjectURL(picture);
    this.urls.set(simulation.name, url);
    this.shown.set(simulation.name, step);
    this.done(simulation.name, url);
  }

  private async fetch(simulation: string): Promise<{ mesh: Mesh; displacement: Float32Array }> {
    const { meshes, frame } = await lastFrame(simulation, ["skin.displacement"], this.leave.signal);
    const [mesh, field] = [meshes.get("skin"), frame.fields.get("skin.displacement")];
    if (!mesh || !field) throw new Error(`${simulation} has no skin`);
    return { mesh, displacement: toNumbers(field) };
  }

  dispose(): void {
    this.leave.abort();
    this.urls.forEach((url) => URL.revokeObjectURL(url));
    this.faces.dispose();
    this.viewport.dispose();
    this.holder.remove();
  }
}

function colour(surface: Surface, displacement: Float32Array): void {
  const moved = new Float32Array(surface.count);
  for (let k = 0; k < moved.length; ++k)
    moved[k] = Math.hypot(displacement[3 * k], displacement[3 * k + 1], displacement[3 * k + 2]);
  const map = mapFor("displacement", Math.max(leastScaleMm, largestOf(moved)));
  for (let k = 0; k < moved.length; ++k) {
    if (moved[k] > 0.05) paint(map, moved[k], surface.colours, 3 * k);
    else surface.colours.set(skinColour, 3 * k);
  }
  surface.recolour();
}
