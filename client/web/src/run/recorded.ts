// A folder that `lipofill run` has written, opened in the page: meshes over time, series and
// summary.
import type vtkPolyData from "@kitware/vtk.js/Common/DataModel/PolyData";
import vtkXMLPolyDataReader from "@kitware/vtk.js/IO/XML/XMLPolyDataReader";
import { fromJson, type JsonValue } from "@bufbuild/protobuf";
import { batch } from "@preact/signals";
import { ArrayType } from "@wire/frame_service_pb";
import { SimulationSchema, type Simulation } from "@wire/simulation_pb";
import type { WireArray } from "../api/arrays";
import type { Coordinates, Mesh } from "../api/meshes";
import type { Frame } from "../api/watch";
import { close, lookAt } from "./run";
import { parseSeries } from "./series_csv";
import { faceMesh, meshes, recorded, rows, runAxes, simulation, store } from "./state";
import type { Point } from "../scene/surface_geometry";

interface Surface {
  mesh: Mesh;
  fields: Map<string, WireArray>;
}

/** Vertices of all polygons; those of other than three or four corners are refused. */
function cellsOf(list: ArrayLike<number>): { cells: Uint32Array; corners: number } {
  const corners = list[0];
  const cells: number[] = [];
  for (let k = 0; k < list.length; k += corners + 1) {
    if (list[k] !== corners || (corners !== 3 && corners !== 4))
      throw new Error("its cells are not all triangles or all quadrilaterals");
    for (let c = 1; c <= corners; ++c) cells.push(list[k + c]);
  }
  return { cells: Uint32Array.from(cells), corners };
}

function floats(name: string, values: ArrayLike<number>, components: number): WireArray {
  const numbers = Float32Array.from(values);
  const shape = components === 1 ? [numbers.length] : [numbers.length / components, components];
  return {
    name,
    unit: "",
    type: ArrayType.FLOAT32,
    shape,
    bytes: new Uint8Array(numbers.buffer),
    boxMin: [],
    boxMax: [],
  };
}

/** A file has double precision where a face lies far from the origin. */
const coordinatesOf = (values: ArrayLike<number>): Coordinates =>
  values instanceof Float64Array ? values : Float32Array.from(values);

async function readSurface(file: File, name: string): Promise<Surface> {
  const reader = vtkXMLPolyDataReader.newInstance();
  reader.parseAsArrayBuffer(await file.arrayBuffer());
  const data = reader.getOutputData(0) as vtkPolyData;
  const mesh = { name, points: coordinatesOf(data.getPoints().getData()), ...cellsOf(data.getPolys().getData()) };
  const fields = new Map<string, WireArray>();
  for (const array of data.getPointData().getArrays()) {
    const field = `${name}.${array.getName().replace(/_(mm|pa)$/, "")}`; // the unit is that of the wire
    fields.set(field, floats(field, array.getData(), array.getNumberOfComponents()));
  }
  return { mesh, fields };
}

/** Times of the frames by their file, from the collection beside them. */
function timesOf(pvd: string): Map<string, number> {
  const sets = new DOMParser().parseFromString(pvd, "text/xml").getElementsByTagName("DataSet");
  return new Map(Array.from(sets, (set) => [set.getAttribute("file") ?? "", Number(set.getAttribute("timestep"))]));
}

/**
 * The state and its figures as `summary.json` has them; fields the schema does not know are left
 * out.
 */
function parseSummary(text: string): Simulation {
  const document = JSON.parse(text) as Record<string, JsonValue>;
  const known = {
    name: "simulations/recorded",
    state: document.state,
    reason: document.reason ?? "",
    summary: document.summary ?? document,
  };
  return fromJson(SimulationSchema, known as JsonValue, { ignoreUnknownFields: true });
}

/** @throws Error that says what is missing */
export async function openFolder(files: File[], progress: (share: number) => void): Promise<void> {
  const byName = new Map(files.map((file) => [file.name, file]));
  const mesh = byName.has("scan.pvd") ? "scan" : "skin";
  const collection = byName.get(`${mesh}.pvd`);
  if (collection === undefined)
    throw new Error("this folder holds no scan.pvd or skin.pvd: choose one that `lipofill run` has written");
  const times = [...timesOf(await collection.text())].filter(([file]) => byName.has(file));
  if (times.length === 0) throw new Error(`none of the files that ${collection.name} names is in this folder`);
  close();
  for (const [index, [file, timeS]] of times.entries()) {
    const surface = await readSurface(byName.get(file)!, mesh);
    if (index === 0) meshes.value = new Map([[mesh, surface.mesh]]);
    const next: Frame = {
      epoch: 1n,
      sequence: BigInt(index),
      timeS,
      preview: false,
      end: index === times.length - 1,
      fields: surface.fields,
    };
    store.add(next);
    progress((index + 1) / times.length);
  }
  const [series, summary] = await Promise.all([byName.get("series.csv")?.text(), byName.get("summary.json")?.text()]);
  const up = (JSON.parse((await byName.get("run.json")?.text()) ?? "{}") as { up?: Point }).up;
  batch(() => {
    if (up) runAxes.value = { up, left: [0, 0, 0], forward: [0, 0, 0] };
    faceMesh.value = mesh;
    recorded.value = collection.webkitRelativePath.split("/")[0] || "recorded run";
    rows.value = series === undefined ? [] : parseSeries(series);
    if (summary !== undefined) simulation.value = parseSummary(summary);
    lookAt(undefined);
  });
}
