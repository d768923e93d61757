// Balls and lines on the skin: landmarks, corners of the region, injection points, walls.
import vtkPolyData from "@kitware/vtk.js/Common/DataModel/PolyData";
import vtkSphereSource from "@kitware/vtk.js/Filters/Sources/SphereSource";
import vtkActor from "@kitware/vtk.js/Rendering/Core/Actor";
import vtkMapper from "@kitware/vtk.js/Rendering/Core/Mapper";
import type { Rgb } from "./colour_maps";
import type { Point } from "./surface_geometry";
import type { Viewport } from "./viewport";

export interface Ball {
  at: Point;
  colour: Rgb;
  radius: number;
}

export interface Line {
  points: Point[];
  colour: Rgb;
}

function share(colour: Rgb): Rgb {
  return colour.map((c) => c / 255) as Rgb;
}

function makeBall({ at, colour, radius }: Ball): vtkActor {
  const source = vtkSphereSource.newInstance({ center: at, radius, thetaResolution: 16, phiResolution: 12 });
  const mapper = vtkMapper.newInstance();
  mapper.setInputConnection(source.getOutputPort());
  const actor = vtkActor.newInstance();
  actor.setMapper(mapper);
  actor.getProperty().setColor(...share(colour));
  actor.getProperty().setAmbient(0.35);
  return actor;
}

function makeLine({ points, colour }: Line): vtkActor {
  const data = vtkPolyData.newInstance();
  data.getPoints().setData(Float64Array.from(points.flat()), 3);
  data.getLines().setData(Uint32Array.from([points.length, ...points.keys()]));
  const mapper = vtkMapper.newInstance();
  mapper.setInputData(data);
  mapper.setResolveCoincidentTopologyToPolygonOffset();
  mapper.setRelativeCoincidentTopologyLineOffsetParameters(-4, -40);
  const actor = vtkActor.newInstance();
  actor.setMapper(mapper);
  actor.getProperty().setColor(...share(colour));
  actor.getProperty().setLineWidth(3);
  actor.getProperty().setLighting(false);
  return actor;
}

export class Markers {
  private shown: vtkActor[] = [];
  constructor(private readonly viewport: Viewport) {}

  show(balls: Ball[], lines: Line[]): void {
    this.clear();
    this.shown = [...balls.map(makeBall), ...lines.filter(({ points }) => points.length > 1).map(makeLine)];
    this.shown.forEach((actor) => this.viewport.add(actor));
    this.viewport.request();
  }

  clear(): void {
    for (const actor of this.shown) {
      this.viewport.remove(actor);
      actor.delete();
    }
    this.shown = [];
  }
}
