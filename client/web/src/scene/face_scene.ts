// The face on the page: before and after, its region and layers, what a frame colours, what lies
// under the cursor.
import type { Coordinates, Mesh } from "../api/meshes";
import type { Frame } from "../api/watch";
import type { ColourMap, Quantity, Rgb } from "./colour_maps";
import {
  colourBy,
  colourFace,
  colourPlain,
  FrameReader,
  largestOf,
  RunningMap,
  valuesOf,
  type FaceNumbers,
} from "./face_colours";
import { makeLayers } from "./layers";
import { Markers } from "./markers";
import { MovingSurface } from "./moving_surface";
import { SecondPicture } from "./second_picture";
import { Surface } from "./surface";
import { castRay, valueAt, type Hit, type Point } from "./surface_geometry";
import { Viewport } from "./viewport";
import { liftView, type Axes, type View } from "./views";

export interface Probe {
  point: Point;
  displacementMm: number;
  pressureMmHg: number;
  thicknessMm: number;
  distanceMm: number | undefined;
}

export class FaceScene {
  readonly viewport: Viewport;
  readonly markers: Markers;
  private second: SecondPicture | undefined;
  private other: { mesh: Mesh; frame: Frame } | undefined;
  private face: MovingSurface | undefined;
  private faceMesh: Mesh | undefined;
  private patch: Surface | undefined;
  private patchShown = true;
  private shownDetail = 1;
  private layers: Surface[] = [];
  private readonly reader = new FrameReader();
  private readonly running = new RunningMap();
  private numbers: FaceNumbers | undefined;
  private distance: Float32Array | undefined;
  private isDark = false;
  private own: Uint8Array | undefined;
  private shown: Quantity | "none" = "none";
  /** told when the colour map is another one */
  onMap: (map: ColourMap) => void = () => undefined;

  constructor(container: HTMLElement) {
    this.viewport = new Viewport(container);
    this.markers = new Markers(this.viewport);
  }

  get hasFace(): boolean {
    return this.face !== undefined;
  }
  get mesh(): Mesh | undefined {
    return this.faceMesh;
  }
  get points(): Coordinates | undefined {
    return this.face?.points;
  }

  /** The surface as it is and at rest [mm]. */
  get shape(): { points: Coordinates; rest: Coordinates; triangles: Uint32Array } | undefined {
    return this.face;
  }

  setFace(mesh: Mesh | undefined): void {
    if (mesh === this.faceMesh) return;
    this.face?.dispose();
    [this.faceMesh, this.numbers, this.distance] = [mesh, undefined, undefined];
    this.running.forget();
    this.face = mesh && new MovingSurface(mesh, this.viewport);
    if (this.face) this.face.coarse = this.shownDetail < 1;
    this.fillSecond();
    this.viewport.request();
  }

  /** The region's skin over the face, coloured a vertex. */
  setPatch(skin: Mesh | undefined, colour: (vertex: number) => Rgb | undefined): void {
    if (this.patch) {
      this.viewport.remove(this.patch.actor);
      this.patch.dispose();
      this.patch = undefined;
    }
    if (skin) {
      this.patch = new Surface(skin);
      this.patch.lift(0.35);
      this.patch.opacity = 0.82;
      this.patch.visible = this.patchShown;
      this.viewport.add(this.patch.actor);
      this.colourPatch(colour);
    }
    this.viewport.request();
  }

  /** Whether the region's skin lies over the face: where the face has moved it would hide it. */
  showPatch(shown: boolean): void {
    this.patchShown = shown;
    if (this.patch) this.patch.visible = shown && this.layers.length === 0;
    this.viewport.request();
  }

  colourPatch(colour: (vertex: number) => Rgb | undefined): void {
    if (!this.patch) return;
    for (let k = 0; k < this.patch.count; ++k) this.patch.colours.set(colour(k) ?? [206, 214, 214], 3 * k);
    this.patch.recolour();
    this.viewport.request();
  }

  /** @param shown  whether each of the model's layers is; the face is then seen through */
  setLayers(tissue: Mesh | undefined, elementsThrough: number[], shown: boolean[]): void {
    for (const layer of this.layers) {
      this.viewport.remove(layer.actor);
      layer.dispose();
    }
    this.layers = tissue === undefined ? [] : makeLayers(tissue, elementsThrough);
    this.layers.forEach((layer, index) => {
      layer.edges = true;
      layer.visible = shown[index] ?? true;
      this.viewport.add(layer.actor);
    });
    if (this.face) this.face.opacity = this.layers.length > 0 ? 0.18 : 1;
    if (this.patch) this.patch.visible = this.patchShown && this.layers.length === 0;
    this.viewport.request();
  }

  setDistance(vertices: ArrayLike<number>, values: ArrayLike<number>): void {
    if (!this.face) return;
    this.distance = new Float32Array(this.face.count).fill(NaN);
    for (let k = 0; k < vertices.length; ++k) this.distance[vertices[k]] = values[k];
  }
  forgetDistance(): void {
    this.distance = undefined;
  }

  /** Moves and colours the face as a frame has it; without one it is at rest. */
  show(frame: Frame | undefined, quantity: Quantity | "none"): void {
    if (!this.face || !this.faceMesh) return;
    if (frame === undefined) {
      this.numbers = undefined;
      this.face.move();
      colourPlain(this.face, this.ownOf(this.face));
    } else {
      this.numbers = this.reader.read(frame, this.faceMesh.name, this.face.count);
      this.face.move(this.numbers.displacement);
      const values = quantity === "none" ? undefined : valuesOf(quantity, this.numbers, this.distance);
      if (
        quantity !== "none" &&
        this.running.fit(
          quantity,
          Math.max(values === undefined ? 1 : largestOf(values), this.second?.largest(quantity) ?? 0),
        )
      )
        this.onMap(this.running.map);
      const shown = values === undefined ? "none" : quantity;
      colourFace(this.face, shown, this.numbers, this.distance, this.running.map, this.ownOf(this.face));
      this.shown = quantity;
      this.second?.colour(quantity, this.running.map);
    }
    this.viewport.request();
  }

  /** Colours the face at rest by signed distances, a vertex; not a number where there is none. */
  showDistances(values: Float32Array, map: ColourMap): void {
    if (!this.face || values.length !== this.face.count) return;
    this.numbers = undefined;
    this.distance = values;
    this.face.move();
    colourBy(this.face, values, map, this.ownOf(this.face));
    this.viewport.request();
  }

  /** The signed distance under a place on the screen [mm], where distances are shown. */
  distanceAt(clientX: number, clientY: number): number | undefined {
    const hit = this.distance && this.hit(clientX, clientY);
    const value = hit && this.face ? valueAt(this.distance!, this.face.triangles, hit) : NaN;
    return Number.isNaN(value) ? undefined : value;
  }

  /** The colours of the scan's vertices (3 n); undefined: the face has that of skin. */
  set ownColours(colours: Uint8Array | undefined) {
    const isOther = colours !== this.own;
    this.own = colours;
    if (isOther) this.fillSecond();
  }
  private ownOf({ colours }: { colours: Uint8Array }): Uint8Array | undefined {
    return this.own?.length === colours.length ? this.own : undefined;
  }

  set dark(wanted: boolean) {
    this.isDark = wanted;
    this.viewport.dark = wanted;
    if (this.second) this.second.viewport.dark = wanted;
  }

  /** Less than 1 where a machine is too slow: fewer pixels, and coarser what does not move. */
  set detail(share: number) {
    this.viewport.detail = share;
    this.shownDetail = share;
    if (this.face) this.face.coarse = share < 1;
  }

  /** The largest displacement shown [mm]. */
  get lift(): number {
    return this.numbers === undefined ? 0 : largestOf(this.numbers.moved);
  }
  liftView(axes: Axes): View | undefined {
    if (!this.face || !this.numbers) return undefined;
    return liftView(this.face.points, this.face.normals, this.numbers.moved, axes);
  }

  /** From outside of where most is missing; undefined where nothing is. */
  missingView(distances: Float32Array, axes: Axes): View | undefined {
    if (!this.face || distances.length !== this.face.count) return undefined;
    const missing = distances.map((value) => (value < 0 ? value * value : 0));
    if (largestOf(missing) === 0) return undefined;
    return liftView(this.face.points, this.face.normals, missing, axes);
  }

  hit(clientX: number, clientY: number): Hit | undefined {
    if (!this.face) return undefined;
    const { from, along } = this.viewport.rayAt(clientX, clientY);
    return castRay(this.face.points, this.face.triangles, from, along);
  }
  hitPatch(clientX: number, clientY: number): Hit | undefined {
    if (!this.patch) return undefined;
    const { from, along } = this.viewport.rayAt(clientX, clientY);
    return castRay(this.patch.rest, this.patch.triangles, from, along);
  }

  probe(clientX: number, clientY: number): Probe | undefined {
    const hit = this.hit(clientX, clientY);
    if (!hit || !this.face || !this.numbers) return undefined;
    const at = (values: Float32Array): number => valueAt(values, this.face!.triangles, hit);
    const distance = this.distance === undefined ? NaN : at(this.distance);
    return {
      point: hit.point,
      displacementMm: at(this.numbers.moved),
      pressureMmHg: at(this.numbers.pressure),
      thicknessMm: at(this.numbers.thickness),
      distanceMm: Number.isNaN(distance) ? undefined : distance,
    };
  }

  /** A second picture, of the face before, turned as the first. */
  compare(container: HTMLElement | undefined): void {
    this.second?.dispose();
    this.second = container && new SecondPicture(container, this.viewport);
    if (this.second === undefined) return;
    this.second.viewport.dark = this.isDark;
    this.fillSecond();
  }

  /** In the second picture: another result, or without one the face before. */
  setOther(other: { mesh: Mesh; frame: Frame } | undefined): void {
    this.other = other;
    this.fillSecond();
  }

  private fillSecond(): void {
    this.second?.show(this.other?.mesh ?? this.faceMesh, this.other?.frame, this.own);
    this.second?.colour(this.shown, this.running.map);
  }

  dispose(): void {
    this.compare(undefined);
    this.markers.clear();
    this.viewport.dispose();
  }
}
