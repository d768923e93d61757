// A picture beside the face's own: the face before, or another result. One camera is for both.
import type { Mesh } from "../api/meshes";
import type { Frame } from "../api/watch";
import type { ColourMap, Quantity } from "./colour_maps";
import { colourFace, colourPlain, FrameReader, largestOf, valuesOf } from "./face_colours";
import { Surface } from "./surface";
import { Viewport } from "./viewport";

export class SecondPicture {
  readonly viewport: Viewport;
  private surface: Surface | undefined;
  private frame: Frame | undefined;
  private mesh: Mesh | undefined;
  private own: Uint8Array | undefined;
  private readonly reader = new FrameReader();

  constructor(
    container: HTMLElement,
    private readonly first: Viewport,
  ) {
    this.viewport = new Viewport(container);
    first.onCamera = (pose) => (this.viewport.pose = pose);
    this.viewport.onCamera = (pose) => (first.pose = pose);
    this.viewport.onTurned = (pose) => first.onTurned(pose);
    this.viewport.pose = first.pose;
  }

  /** @param frame  of another result; undefined: the face at rest */
  show(mesh: Mesh | undefined, frame: Frame | undefined, own: Uint8Array | undefined): void {
    this.drop();
    [this.mesh, this.frame] = [mesh, frame];
    this.surface = mesh && new Surface(mesh);
    if (this.surface) {
      this.own = own?.length === this.surface.colours.length ? own : undefined;
      colourPlain(this.surface, this.own);
      this.viewport.add(this.surface.actor);
    }
    this.viewport.request();
  }

  /** The largest value of what is shown of another result. */
  largest(quantity: Quantity): number {
    if (!this.frame || !this.mesh || quantity === "distance") return 0;
    const numbers = this.reader.read(this.frame, this.mesh.name, this.mesh.points.length / 3);
    return largestOf(valuesOf(quantity, numbers, undefined)!);
  }

  /** The same colour means the same in both pictures. */
  colour(quantity: Quantity | "none", map: ColourMap): void {
    if (!this.frame || !this.mesh || !this.surface) return;
    const numbers = this.reader.read(this.frame, this.mesh.name, this.surface.count);
    this.surface.move(numbers.displacement);
    colourFace(this.surface, quantity === "distance" ? "none" : quantity, numbers, undefined, map, this.own);
    this.viewport.request();
  }

  private drop(): void {
    if (!this.surface) return;
    this.viewport.remove(this.surface.actor);
    this.surface.dispose();
  }

  dispose(): void {
    this.first.onCamera = () => undefined;
    this.viewport.dispose();
    this.surface?.dispose();
  }
}
