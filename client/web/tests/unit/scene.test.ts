import { describe, expect, it } from "vitest";
import { bandOf, mapFor, mmHgPerPa, paint, pressureBands, roundUp } from "../../src/scene/colour_maps";
import { castRay, computeNormals, valueAt } from "../../src/scene/surface_geometry";
import { outerFaces } from "../../src/scene/layers";
import { MovingSurface } from "../../src/scene/moving_surface";
import type vtkActor from "@kitware/vtk.js/Rendering/Core/Actor";
import type vtkPolyData from "@kitware/vtk.js/Common/DataModel/PolyData";

describe("pressure bands", () => {
  it("begin at 9, 15 and 30 mmHg", () => {
    expect([0, 8.99, 9, 14.99, 15, 29.9, 30, 200].map(bandOf)).toEqual([0, 0, 1, 1, 2, 2, 3, 3]);
    expect(1200 * mmHgPerPa).toBeCloseTo(9.0, 2);
  });
  it("are on the map as they are on the skin", () => {
    const map = mapFor("pressure", 12);
    const out = new Uint8Array(3);
    paint(map, 12, out, 0);
    expect([...out]).toEqual(pressureBands[1].colour);
  });
  it("grow darker, for those who do not see their hue", () => {
    const lightness = pressureBands.map(({ colour: [r, g, b] }) => 0.2126 * r + 0.7152 * g + 0.0722 * b);
    expect(lightness[1]).toBeGreaterThan(lightness[2]);
    expect(lightness[2]).toBeGreaterThan(lightness[3] + 30);
  });
});

describe("colour maps", () => {
  it("end at round numbers", () => {
    expect([0.04, 1.2, 4.6, 31, 0].map(roundUp)).toEqual([0.04, 1.5, 5, 40, 1]);
  });
  it("hold distances about zero", () => {
    const map = mapFor("distance", 4.2);
    expect([map.low, map.high]).toEqual([-5, 5]);
  });
  it("take what lies beyond by their ends", () => {
    const map = mapFor("displacement", 5);
    const out = new Uint8Array(6);
    paint(map, 99, out, 0);
    paint(map, 5, out, 3);
    expect([...out.subarray(0, 3)]).toEqual([...out.subarray(3)]);
  });
});

describe("a surface", () => {
  const points = Float32Array.from([0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, -1, 2, 0, -1, 0, 2, -1]);
  const triangles = Uint32Array.from([0, 1, 2, 3, 4, 5]);
  it("has unit normals", () => {
    const normals = new Float32Array(points.length);
    computeNormals(points, triangles, normals);
    expect([...normals.subarray(0, 3)]).toEqual([0, 0, 1]);
  });
  it("is met at its front", () => {
    const hit = castRay(points, triangles, [0.5, 0.5, 5], [0, 0, -1])!;
    expect(hit.triangle).toBe(0);
    expect(hit.distance).toBeCloseTo(5);
    expect(valueAt([0, 4, 8, 0, 0, 0], triangles, hit)).toBeCloseTo(3);
    expect(castRay(points, triangles, [3, 3, 5], [0, 0, -1])).toBeUndefined();
  });
});

describe("a layer", () => {
  it("shows the faces that two hexahedra do not share", () => {
    const cells = Uint32Array.from([0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 9, 10, 11]);
    expect(outerFaces(cells)).toHaveLength(10 * 4);
  });
});

describe("a surface of which a part moves", () => {
  /** 20 x 20 vertices in a plane. */
  const side = 20;
  const points = Float32Array.from(
    Array.from({ length: side * side }, (_, k) => [k % side, Math.floor(k / side), 0]).flat(),
  );
  const cells: number[] = [];
  for (let j = 0; j + 1 < side; ++j)
    for (let i = 0; i + 1 < side; ++i) {
      const k = j * side + i;
      cells.push(k, k + 1, k + side + 1, k, k + side + 1, k + side);
    }
  const mesh = { name: "scan", points, cells: Uint32Array.from(cells), corners: 3 };
  const bump = (vertices: number[], height: number): Float32Array => {
    const displacement = new Float32Array(points.length);
    for (const vertex of vertices) displacement[3 * vertex + 2] = height;
    return displacement;
  };

  class Scene {
    readonly actors = new Set<vtkActor>();
    add = (actor: vtkActor): void => void this.actors.add(actor);
    remove = (actor: vtkActor): void => void this.actors.delete(actor);
    /** Sizes of what is drawn, and the highest point of it. */
    get drawn(): { triangles: number[]; highest: number } {
      const data = [...this.actors].map((actor) => actor.getMapper()!.getInputData() as vtkPolyData);
      return {
        triangles: data.map((one) => one.getPolys().getNumberOfCells()),
        highest: Math.max(
          ...data.flatMap((one) => Array.from(one.getPoints().getData()).filter((_, k) => k % 3 === 2)),
        ),
      };
    }
  }

  it("sends what is still only once, and loses no triangle", () => {
    const scene = new Scene();
    const surface = new MovingSurface(mesh, scene);
    const all = cells.length / 3;
    surface.move(bump([], 0));
    expect(scene.drawn.triangles).toEqual([all]);
    surface.move(bump([210], 2));
    const [still, moving] = scene.drawn.triangles;
    expect(still + moving).toBe(all);
    expect(moving).toBeLessThan(30);
    expect(scene.drawn.highest).toBe(2);
    const actors = [...scene.actors];
    surface.move(bump([210], 3));
    expect([...scene.actors]).toEqual(actors);
    expect(scene.drawn.highest).toBe(3);
    surface.move(bump([210, 50], 3));
    expect(scene.drawn.triangles.reduce((a, b) => a + b)).toBe(all);
    surface.move();
    expect(scene.drawn.highest).toBe(0);
    surface.dispose();
    expect(scene.actors.size).toBe(0);
  });
  it("is coarser where it is still, as long as that is wanted", () => {
    const scene = new Scene();
    const surface = new MovingSurface({ ...mesh, points: points.map((v) => 2 * v) }, scene);
    const shown = (): number => {
      const actors = [...scene.actors].filter((actor) => actor.getVisibility());
      return actors
        .map((actor) => (actor.getMapper()!.getInputData() as vtkPolyData).getPolys().getNumberOfCells())
        .reduce((a, b) => a + b);
    };
    surface.move(bump([210], 2));
    surface.coarse = true;
    expect(shown()).toBeLessThan(0.4 * (cells.length / 3));
    expect(scene.drawn.highest).toBe(2);
    surface.move(bump([210, 50], 3));
    expect(shown()).toBeLessThan(0.5 * (cells.length / 3));
    surface.coarse = false;
    expect(shown()).toBe(cells.length / 3);
    surface.dispose();
    expect(scene.actors.size).toBe(0);
  });
  it("stays whole where most of it moves", () => {
    const scene = new Scene();
    const surface = new MovingSurface(mesh, scene);
    surface.move(bump([...points.keys()].slice(0, side * side), 1));
    expect(scene.drawn.triangles).toEqual([cells.length / 3]);
    expect(scene.drawn.highest).toBe(1);
  });
  it("is coloured as a whole", () => {
    const scene = new Scene();
    const surface = new MovingSurface(mesh, scene);
    surface.move(bump([210], 2));
    surface.fill([1, 2, 3]);
    surface.recolour();
    for (const actor of scene.actors) {
      const data = actor.getMapper()!.getInputData() as vtkPolyData;
      expect(Array.from(data.getPointData().getScalars().getData()).slice(0, 3)).toEqual([1, 2, 3]);
    }
  });
});
