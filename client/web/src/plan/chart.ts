// The model's skin as the chart it is: nodes in rows, and zones painted over them.
import { create } from "@bufbuild/protobuf";
import { FieldSamplesSchema, type FieldSamples } from "@wire/geometry_pb";
import type { Mesh } from "../api/meshes";
import { distanceOf, type Point } from "../scene/surface_geometry";

export class Chart {
  readonly nXi: number;
  readonly nEta: number;

  /** @param skin  quadrilaterals of n_xi by n_eta, nodes with xi running fastest */
  constructor(readonly skin: Mesh) {
    // The second corner of the first cell is its neighbour along xi, the fourth along eta: one row
    // further.
    this.nXi = skin.cells[3] - skin.cells[0] - 1;
    this.nEta = skin.points.length / 3 / (this.nXi + 1) - 1;
    if (!Number.isInteger(this.nEta) || this.nXi < 1 || this.nEta < 1) throw new Error("the model's skin is no grid");
  }

  node(index: number): Point {
    const { points } = this.skin;
    return [points[3 * index], points[3 * index + 1], points[3 * index + 2]];
  }

  /** Bilinear between the nodes. */
  position(xi: number, eta: number): Point {
    const x = Math.min(Math.max(xi, 0), 1) * this.nXi;
    const y = Math.min(Math.max(eta, 0), 1) * this.nEta;
    const i = Math.min(Math.floor(x), this.nXi - 1);
    const j = Math.min(Math.floor(y), this.nEta - 1);
    const [s, t] = [x - i, y - j];
    const row = this.nXi + 1;
    const at: Point = [0, 0, 0];
    const corners: [number, number][] = [
      [j * row + i, (1 - s) * (1 - t)],
      [j * row + i + 1, s * (1 - t)],
      [(j + 1) * row + i, (1 - s) * t],
      [(j + 1) * row + i + 1, s * t],
    ];
    for (const [index, weight] of corners) this.node(index).forEach((v, c) => (at[c] += weight * v));
    return at;
  }

  empty(): FieldSamples {
    const [nXi, nEta] = [this.nXi + 1, this.nEta + 1];
    return create(FieldSamplesSchema, { nXi, nEta, values: new Array<number>(nXi * nEta).fill(0) });
  }

  fits(samples: FieldSamples): boolean {
    return samples.nXi === this.nXi + 1 && samples.nEta === this.nEta + 1;
  }

  /** Sets the nodes within a distance [mm] of a place; whether any of them changed. */
  brush(samples: FieldSamples, centre: Point, radius: number, value: 0 | 1): boolean {
    let changed = false;
    for (let index = 0; index < samples.values.length; ++index) {
      if (samples.values[index] === value || distanceOf(this.node(index), centre) > radius) continue;
      samples.values[index] = value;
      changed = true;
    }
    return changed;
  }
}
