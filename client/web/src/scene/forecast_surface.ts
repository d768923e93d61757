// The skin of the model over the face, moved and coloured as a forecast has it.
import type { Mesh } from "../api/meshes";
import { paint, type ColourMap } from "./colour_maps";
import { Surface } from "./surface";
import { castRay, valueAt } from "./surface_geometry";
import type { Viewport } from "./viewport";

/** So far outside the face it is drawn, where both would be at one place [mm]. */
const liftMm = 0.35;

export interface ForecastSkin {
  skin: Mesh;
  /** mm (3 n) */
  displacement: Float32Array;
  /** mm (n) */
  values: Float32Array;
  map: ColourMap;
}

export class ForecastSurface {
  private surface: Surface | undefined;
  private of: Mesh | undefined;

  constructor(private readonly viewport: Viewport) {}

  show(next: ForecastSkin | undefined): void {
    if (next?.skin !== this.of) {
      this.drop();
      if (next) {
        this.surface = new Surface(next.skin);
        this.viewport.add(this.surface.actor);
      }
      this.of = next?.skin;
    }
    if (next && this.surface) {
      this.surface.move(next.displacement);
      const { points, normals } = this.surface;
      for (let k = 0; k < points.length; ++k) points[k] += liftMm * normals[k];
      this.surface.moved();
      for (let k = 0; k < this.surface.count; ++k) paint(next.map, next.values[k], this.surface.colours, 3 * k);
      this.surface.recolour();
    }
    this.viewport.request();
  }

  /** Values of the vertices, under a place on the screen. */
  valuesAt(clientX: number, clientY: number, all: Float32Array[]): number[] | undefined {
    if (!this.surface) return undefined;
    const { from, along } = this.viewport.rayAt(clientX, clientY);
    const { points, triangles } = this.surface;
    const hit = castRay(points, triangles, from, along);
    return hit && all.map((values) => valueAt(values, triangles, hit));
  }

  private drop(): void {
    if (!this.surface) return;
    this.viewport.remove(this.surface.actor);
    this.surface.dispose();
    this.surface = undefined;
  }

  dispose(): void {
    this.drop();
  }
}
