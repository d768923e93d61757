// A surface in the scene: it moves, and every vertex has a colour.
import vtkDataArray from "@kitware/vtk.js/Common/Core/DataArray";
import vtkPolyData from "@kitware/vtk.js/Common/DataModel/PolyData";
import vtkActor from "@kitware/vtk.js/Rendering/Core/Actor";
import vtkMapper from "@kitware/vtk.js/Rendering/Core/Mapper";
import { trianglesOf, type Coordinates, type Mesh } from "../api/meshes";
import { computeNormals } from "./surface_geometry";
import { skinColour, type Rgb } from "./colour_maps";

export class Surface {
  readonly actor = vtkActor.newInstance();
  /** as shown [mm] (3 n) */
  readonly points: Coordinates;
  readonly normals: Float32Array;
  /** (3 n) bytes, changed by whoever paints, then shown by recolour() */
  readonly colours: Uint8Array;
  private readonly data = vtkPolyData.newInstance();
  private readonly normalArray: vtkDataArray;
  private readonly colourArray: vtkDataArray;

  readonly rest: Coordinates;
  readonly triangles: Uint32Array;

  constructor(mesh: Mesh, colour: Rgb = skinColour) {
    this.rest = mesh.points;
    this.triangles = trianglesOf(mesh);
    this.points = this.rest.slice();
    this.normals = new Float32Array(this.rest.length);
    this.colours = new Uint8Array(this.rest.length);
    this.fill(colour);
    computeNormals(this.points, this.triangles, this.normals);
    this.data.getPoints().setData(this.points, 3);
    this.data.getPolys().setData(listed(mesh));
    this.normalArray = vtkDataArray.newInstance({ name: "normals", numberOfComponents: 3, values: this.normals });
    this.colourArray = vtkDataArray.newInstance({ name: "colours", numberOfComponents: 3, values: this.colours });
    this.data.getPointData().setNormals(this.normalArray);
    this.data.getPointData().setScalars(this.colourArray);
    const mapper = vtkMapper.newInstance();
    mapper.setInputData(this.data);
    mapper.setColorModeToDirectScalars();
    this.actor.setMapper(mapper);
    const property = this.actor.getProperty();
    property.setAmbient(0.22);
    property.setDiffuse(0.78);
    property.setSpecular(0.06);
    property.setSpecularPower(18);
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
    computeNormals(this.points, this.triangles, this.normals);
    this.moved();
  }

  /** Shows points and normals as somebody else has written them. */
  moved(): void {
    this.data.getPoints().modified();
    this.normalArray.modified();
    this.data.modified();
  }

  /** Lifts the surface off one it lies on. */
  lift(distance: number): void {
    for (let k = 0; k < this.points.length; ++k) this.points[k] = this.rest[k] + distance * this.normals[k];
    this.data.getPoints().modified();
    this.data.modified();
  }

  recolour(): void {
    this.colourArray.modified();
    this.data.modified();
  }

  set opacity(value: number) {
    this.actor.getProperty().setOpacity(value);
  }
  set visible(value: boolean) {
    this.actor.setVisibility(value);
  }
  set edges(value: boolean) {
    this.actor.getProperty().setEdgeVisibility(value);
    this.actor.getProperty().setEdgeColor(0.25, 0.35, 0.4);
  }

  dispose(): void {
    this.actor.delete();
    this.data.delete();
  }
}

/** Each cell behind the number of its corners, as the toolkit stores cells. */
function listed({ cells, corners }: Mesh): Uint32Array {
  const list = new Uint32Array((cells.length / corners) * (corners + 1));
  for (let from = 0, to = 0; from < cells.length; from += corners) {
    list[to++] = corners;
    for (let c = 0; c < corners; ++c) list[to++] = cells[from + c];
  }
  return list;
}
