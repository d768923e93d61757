// A surface of which only a part moves. The toolkit sends a surface to the graphics card anew when
// it changes: the part that is still is sent once, however large the face is. Where a machine is
// too slow that part is drawn coarser.
import type vtkActor from "@kitware/vtk.js/Rendering/Core/Actor";
import { likeThese, trianglesOf, type Coordinates, type Mesh } from "../api/meshes";
import type { Rgb } from "./colour_maps";
import { skinColour } from "./colour_maps";
import { Surface } from "./surface";
import { computeNormals, type Point } from "./surface_geometry";

/** What moves less than this is still: it is less than a frame's fields resolve [mm]. */
const stillMm = 0.01;
/** Cells of what is still, where it is drawn coarser: a face is known in them [mm]. */
const coarseMm = 5;
/** Colours that differ by less look alike: what hardly moves is hardly tinted. */
const faint = 8;
/** Where more than this share of the triangles moves, it is not worth to part them. */
const mostMoving = 0.6;

interface Part {
  surface: Surface;
  /** its vertices among those of the whole */
  vertices: Uint32Array;
}

/** Which vertex is drawn in place of another one, and the normals of all. */
interface Clusters {
  stands: Uint32Array;
  normals: Float32Array;
}

/** Whether a triangle is turned against the normals of its corners. */
function isTurned(points: Coordinates, normals: Float32Array, [a, b, c]: number[]): boolean {
  const edge = (to: number): Point => [0, 1, 2].map((k) => points[3 * to + k] - points[3 * a + k]) as Point;
  const [u, v] = [edge(b), edge(c)];
  const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const along = normal.map((value, k) => value * (normals[3 * a + k] + normals[3 * b + k] + normals[3 * c + k]));
  return along[0] + along[1] + along[2] < 0;
}

/**
 * The triangles of a mesh that are chosen, with the vertices they use. In clusters, triangles that
 * shrink to an edge or a point go, and those that turn over are turned back: they would be dark.
 */
function partOf(mesh: Mesh, triangles: Uint32Array, isChosen: (first: number) => boolean, clusters?: Clusters): Part {
  const number = new Map<number, number>();
  const cells: number[] = [];
  for (let t = 0; t < triangles.length; t += 3) {
    if (!isChosen(t)) continue;
    let corners = [triangles[t], triangles[t + 1], triangles[t + 2]];
    if (clusters) {
      corners = corners.map((vertex) => clusters.stands[vertex]);
      if (corners[0] === corners[1] || corners[1] === corners[2] || corners[2] === corners[0]) continue;
      if (isTurned(mesh.points, clusters.normals, corners)) corners.reverse();
    }
    for (const vertex of corners) {
      let k = number.get(vertex);
      if (k === undefined) number.set(vertex, (k = number.size));
      cells.push(k);
    }
  }
  const vertices = Uint32Array.from(number.keys());
  const points = likeThese(mesh.points, 3 * vertices.length);
  gather(mesh.points, vertices, points);
  return { vertices, surface: new Surface({ name: mesh.name, points, cells: Uint32Array.from(cells), corners: 3 }) };
}

/**
 * For each vertex the first one in its cell of a grid; vertices that are kept stand for themselves.
 */
function clustered(points: Coordinates, isKept: Uint8Array): Uint32Array {
  const firstIn = new Map<string, number>();
  const stands = new Uint32Array(isKept.length);
  for (let vertex = 0; vertex < stands.length; ++vertex) {
    stands[vertex] = vertex;
    if (isKept[vertex] === 1) continue;
    const cell = [0, 1, 2].map((c) => Math.floor(points[3 * vertex + c] / coarseMm)).join();
    const first = firstIn.get(cell);
    if (first === undefined) firstIn.set(cell, vertex);
    else stands[vertex] = first;
  }
  return stands;
}

function gather(from: ArrayLike<number>, vertices: Uint32Array, to: Coordinates | Uint8Array): void {
  for (let k = 0, at = 0; k < vertices.length; ++k) {
    const source = 3 * vertices[k];
    to[at++] = from[source];
    to[at++] = from[source + 1];
    to[at++] = from[source + 2];
  }
}

export class MovingSurface {
  readonly rest: Coordinates;
  readonly triangles: Uint32Array;
  /** as shown [mm] (3 n) */
  readonly points: Coordinates;
  readonly normals: Float32Array;
  /** (3 n) bytes, changed by whoever paints, then shown by recolour() */
  readonly colours: Uint8Array;
  private still: Part;
  /** The same, coarser; there once it was wanted. */
  private stillCoarse: Part | undefined;
  private isCoarse = false;
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
    if (surface.colours.every((value, k) => Math.abs(value - this.stillColours[k]) <= faint)) return;
    this.stillColours.set(surface.colours);
    surface.recolour();
    if (this.stillCoarse === undefined) return;
    gather(this.colours, this.stillCoarse.vertices, this.stillCoarse.surface.colours);
    this.stillCoarse.surface.recolour();
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
    const { triangles } = this;
    const goes = (t: number): boolean => this.goes(t);
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
    this.showStill();
  }

  /** Whether what is still is drawn coarser; what moves never is. */
  set coarse(wanted: boolean) {
    if (wanted === this.isCoarse) return;
    this.isCoarse = wanted;
    this.showStill();
  }

  private showStill(): void {
    const isCoarse = this.isCoarse && this.moving !== undefined;
    if (isCoarse && this.stillCoarse === undefined) {
      const { triangles, isMoving } = this;
      const stays = (t: number): boolean => !this.goes(t);
      this.stillCoarse = partOf(this.mesh, triangles, stays, {
        stands: clustered(this.rest, isMoving),
        normals: this.normals,
      });
      this.place(this.stillCoarse);
      gather(this.colours, this.stillCoarse.vertices, this.stillCoarse.surface.colours);
      this.stillCoarse.surface.recolour();
      this.stillCoarse.surface.opacity = this.shownOpacity;
      this.scene.add(this.stillCoarse.surface.actor);
    }
    if (this.stillCoarse) this.stillCoarse.surface.visible = isCoarse;
    this.still.surface.visible = !isCoarse;
  }

  private goes(t: number): boolean {
    const { triangles, isMoving } = this;
    return isMoving[triangles[t]] + isMoving[triangles[t + 1]] + isMoving[triangles[t + 2]] === 3;
  }

  private place({ surface, vertices }: Part): void {
    gather(this.points, vertices, surface.points);
    gather(this.normals, vertices, surface.normals);
    surface.moved();
  }

  private get parts(): Part[] {
    return [this.still, this.stillCoarse, this.moving].filter((part) => part !== undefined);
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
    this.stillCoarse = undefined;
  }

  dispose(): void {
    this.drop();
  }
}
