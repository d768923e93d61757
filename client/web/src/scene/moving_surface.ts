// A surface of which only a part moves. The toolkit sends a surface to the graphics card anew when
// it changes: the part that is still is sent once, however large the face is.
import type vtkActor from "@kitware/vtk.js/Rendering/Core/Actor";
import { trianglesOf, type Mesh } from "../api/meshes";
import type { Rgb } from "./colour_maps";
import { skinColour } from "./colour_maps";
import { Surface } from "./surface";
import { computeNormals } from "./surface_geometry";

/** What moves less than this is still: it is less than a frame's fields resolve [mm]. */
const stillMm = 0.01;
/** Where more than this share of the triangles moves, it is not worth to part them. */
const mostMoving = 0.6;

interface Part {
  surface: Surface;
  /** its vertices among those of the whole */
  vertices: Uint32Array;
}

/** The triangles of a mesh that are chosen, with the vertices they use. */
function partOf(mesh: Mesh, triangles: Uint32Array, isChosen: (first: number) => boolean): Part {
  const number = new Map<number, number>();
  const cells: number[] = [];
  for (let t = 0; t < triangles.length; t += 3) {
    if (!isChosen(t)) continue;
    for (let c = 0; c < 3; ++c) {
      const vertex = triangles[t + c];
      let k = number.get(vertex);
      if (k === undefined) number.set(vertex, (k = number.size));
      cells.push(k);
    }
  }
  const vertices = Uint32Array.from(number.keys());
  const points = new Float32Array(3 * vertices.length);
  gather(mesh.points, vertices, points);
  return { vertices, surface: new Surface({ name: mesh.name, points, cells: Uint32Array.from(cells), corners: 3 }) };
}

function gather(from: ArrayLike<number>, vertices: Uint32Array, to: { [index: number]: number }): void {
  for (let k = 0, at = 0; k < vertices.length; ++k) {
    const source = 3 * vertices[k];
    to[at++] = from[source];
    to[at++] = from[source + 1];
    to[at++] = from[source + 2];
  }
}

export class MovingSurface {
  readonly rest: Float32Array;
  readonly triangles: Uint32Array;
  /** as shown [mm] (3 n) */
  readonly points: Float32Array;
  readonly normals: Float32Array;
  /** (3 n) bytes, changed by whoever paints, then shown by recolour() */
  readonly colours: Uint8Array;
  private still: Part;
  private moving: Part | undefined;
  /** of vertices, 1 for those of triangles that move */
  private readonly isMoving: Uint8Array;
  private shownOpacity = 1;
  /** the colours of the part that is still, as it has them */
  private stillColours: Uint8Array;

  constructor(
    private readonly mesh: Mesh,
    private readonly scene: { add: (actor: vtkActor) => void; remove: (actor: vtkActor) => void },
  ) {
    this.rest = mesh.points;
    this.triangles = trianglesOf(mesh);
    this.points = this.rest.slice();
    this.normals = new Float32Array(this.rest.length);
    this.colours = new Uint8Array(this.rest.length);
    this.isMoving = new Uint8Array(this.count);
    this.fill(skinColour);
    computeNormals(this.points, this.triangles, this.normals);
    this.still = partOf(mesh, this.triangles, () => true);
    this.stillColours = this.still.surface.colours.slice();
    scene.add(this.still.surface.actor);
  }

  get count(): number {
    return this.rest.length / 3;
  }

  fill(colour: Rgb): void {
    for (let k = 0; k < this.colours.length; k += 3) this.colours.set(colour, k);
  }

  /** @param displacement [mm] (3 n); absent: at rest */
  move(displacement?: Float32Array): void {
    if (displacement === undefined) this.points.set(this.rest);
    else for (let k = 0; k < this.points.length; ++k) this.points[k] = this.rest[k] + displacement[k];
    if (displacement !== undefined && this.takeWhatMoves(displacement)) this.part();
    computeNormals(this.points, this.triangles, this.normals);
    this.place(this.moving ?? this.still);
  }

  recolour(): void {
    if (this.moving) {
      gather(this.colours, this.moving.vertices, this.moving.surface.colours);
      this.moving.surface.recolour();
    }
    const { surface, vertices } = this.still;
    gather(this.colours, vertices, surface.colours);
    if (surface.colours.every((value, k) => value === this.stillColours[k])) return;
    this.stillColours.set(surface.colours);
    surface.recolour();
  }

  /** Marks vertices of triangles that move; whether there are new ones. */
  private takeWhatMoves(displacement: Float32Array): boolean {
    const { triangles, isMoving } = this;
    const moves = (vertex: number): boolean =>
      Math.abs(displacement[3 * vertex]) > stillMm ||
      Math.abs(displacement[3 * vertex + 1]) > stillMm ||
      Math.abs(displacement[3 * vertex + 2]) > stillMm;
    let isNew = false;
    for (let vertex = 0; vertex < isMoving.length && !isNew; ++vertex) isNew = isMoving[vertex] === 0 && moves(vertex);
    if (!isNew) return false;
    for (let t = 0; t < triangles.length; t += 3)
      if (moves(triangles[t]) || moves(triangles[t + 1]) || moves(triangles[t + 2]))
        isMoving[triangles[t]] = isMoving[triangles[t + 1]] = isMoving[triangles[t + 2]] = 1;
    return true;
  }

  /** Parts what moves from what is still. */
  private part(): void {
    const { triangles, isMoving } = this;
    const goes = (t: number): boolean =>
      isMoving[triangles[t]] === 1 && isMoving[triangles[t + 1]] === 1 && isMoving[triangles[t + 2]] === 1;
    let count = 0;
    for (let t = 0; t < triangles.length; t += 3) if (goes(t)) ++count;
    this.drop();
    const parted = count * 3 <= mostMoving * triangles.length;
    this.still = partOf(this.mesh, triangles, (t) => !parted || !goes(t));
    this.moving = parted ? partOf(this.mesh, triangles, goes) : undefined;
    this.stillColours = this.still.surface.colours.slice();
    computeNormals(this.points, triangles, this.normals);
    this.place(this.still);
    for (const part of this.parts) this.scene.add(part.surface.actor);
    this.opacity = this.shownOpacity;
  }

  private place({ surface, vertices }: Part): void {
    gather(this.points, vertices, surface.points);
    gather(this.normals, vertices, surface.normals);
    surface.moved();
  }

  private get parts(): Part[] {
    return this.moving ? [this.still, this.moving] : [this.still];
  }

  set opacity(value: number) {
    this.shownOpacity = value;
    for (const { surface } of this.parts) surface.opacity = value;
  }

  private drop(): void {
    for (const { surface } of this.parts) {
      this.scene.remove(surface.actor);
      surface.dispose();
    }
  }

  dispose(): void {
    this.drop();
  }
}
