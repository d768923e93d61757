// Landmark files of other programs, as client/cpp/landmark_formats.h reads them: 3D Slicer, MeshLab
// and tables. Positions come in LPS where the file tells its frame.
import type { Point } from "../scene/surface_geometry";

/** The points of a file in its order and unit. */
export interface LandmarkList {
  points: [string, Point][];
  /** where the file tells */
  millimetresPerUnit?: number;
  wasRas?: boolean;
}

function number(text: unknown, what: string): number {
  const value = typeof text === "number" ? text : typeof text === "string" && text !== "" ? Number(text) : NaN;
  if (!Number.isFinite(value)) throw new Error(`${what} is ${JSON.stringify(text)}, must be a number`);
  return value;
}

const turned = (isRas: boolean, [x, y, z]: Point): Point => (isRas ? [0 - x, 0 - y, z] : [x, y, z]);

function isRas(system: string, known: Record<string, boolean>): boolean {
  if (system in known) return known[system];
  throw new Error(`the coordinate system is ${JSON.stringify(system)}, must be LPS or RAS`);
}
const systems = { LPS: false, "1": false, RAS: true, "0": true };

export interface Markup {
  coordinateSystem?: string;
  coordinateUnits?: string | string[];
  controlPoints?: { label?: string; position?: unknown; positionStatus?: string }[];
}

const units: Record<string, number> = { mm: 1, cm: 10, m: 1000, um: 0.001 };

/** Markups of 3D Slicer (.mrk.json). */
export function parseMarkups(markups: Markup[]): LandmarkList {
  const list: LandmarkList = { points: [] };
  for (const markup of markups) {
    const ras = isRas(String(markup.coordinateSystem ?? "LPS"), systems);
    if (ras) list.wasRas = true;
    const unit = Array.isArray(markup.coordinateUnits) ? markup.coordinateUnits[0] : markup.coordinateUnits;
    if (unit !== undefined && !(unit in units)) throw new Error(`coordinateUnits is ${JSON.stringify(unit)}`);
    if (unit !== undefined) list.millimetresPerUnit = units[unit];
    for (const { label, position, positionStatus } of markup.controlPoints ?? []) {
      if (!label || (positionStatus ?? "defined") !== "defined") continue;
      if (!Array.isArray(position) || position.length !== 3)
        throw new Error(`${label} has no position of three numbers`);
      const at = position.map((value) => number(value, `the position of ${label}`)) as Point;
      list.points.push([label, turned(ras, at)]);
    }
  }
  return list;
}

const linesOf = (text: string): string[] => text.replace(/^\uFEFF/, "").split(/\r\n|\n|\r/);

/** The cells of a line; one in quotation marks may hold the separator, and a doubled mark. */
function cellsOf(line: string, separator: string): string[] {
  const cells = [""];
  let quoted = false;
  for (let k = 0; k < line.length; ++k) {
    if (line[k] === '"' && quoted && line[k + 1] === '"') cells[cells.length - 1] += line[++k];
    else if (line[k] === '"') quoted = !quoted;
    else if (line[k] === separator && !quoted) cells.push("");
    else cells[cells.length - 1] += line[k];
  }
  return cells.map((cell) => cell.trim());
}

/** Fiducials of 3D Slicer (.fcsv). */
export function parseFcsv(text: string): LandmarkList {
  let ras = true;
  let columns = { label: 11, x: 1, y: 2, z: 3 };
  const list: LandmarkList = { points: [] };
  for (const line of linesOf(text)) {
    const [, key, value] = /^#\s*(\w+)\s*=\s*(.*)$/.exec(line) ?? [];
    if (key === "CoordinateSystem") ras = isRas(value.trim(), systems);
    if (key === "columns") {
      const names = cellsOf(value, ",");
      const at = (name: string): number => names.indexOf(name);
      columns = { label: at("label"), x: at("x"), y: at("y"), z: at("z") };
    }
    if (line.startsWith("#") || line.trim() === "") continue;
    const cells = cellsOf(line, ",");
    const label = cells[columns.label];
    if (!label) continue;
    const at = [columns.x, columns.y, columns.z].map((k) => number(cells[k], `a coordinate of ${label}`)) as Point;
    list.points.push([label, turned(ras, at)]);
  }
  list.wasRas = ras;
  return list;
}

const entities: Record<string, string> = { lt: "<", gt: ">", amp: "&", quot: '"', apos: "'" };

/** Points picked in MeshLab (.pp): of this XML the elements "point" and their attributes count. */
export function parsePickedPoints(text: string): LandmarkList {
  if (!text.includes("<PickedPoints")) throw new Error("this file has no element PickedPoints");
  const list: LandmarkList = { points: [] };
  for (const [, body] of text.matchAll(/<point\b((?:[^>"']|"[^"]*"|'[^']*')*)>/g)) {
    const read: Record<string, string> = {};
    for (const [, key, double, single] of body.matchAll(/(\w+)\s*=\s*(?:"([^"]*)"|'([^']*)')/g))
      read[key] = (double ?? single).replace(/&(\w+);/g, (whole, name: string) => entities[name] ?? whole);
    if (read.active === "0" || !read.name) continue;
    const at = ["x", "y", "z"].map((key) => number(read[key], `${key} of ${read.name}`)) as Point;
    list.points.push([read.name, at]);
  }
  return list;
}

interface Columns {
  name: number;
  xyz: number[];
  placed: number;
  ras: boolean;
  millimetresPerUnit?: number;
}

/** The columns as a line of names gives them; undefined for a line that is none. */
function readHeading(cells: string[]): Columns | undefined {
  const columns: Columns = { name: -1, xyz: [-1, -1, -1], placed: -1, ras: false };
  cells.forEach((cell, k) => {
    const [, name, unit] = /^(\w+?)(?:[_ ]?[([]?(mm|cm|m)[)\]]?)?$/.exec(cell.toLowerCase()) ?? [];
    if (name === undefined) return;
    const axis = ["xrl", "yap", "zs"].findIndex((letters) => name.length === 1 && letters.includes(name));
    if (axis >= 0) {
      columns.xyz[axis] = k;
      if (unit !== undefined) columns.millimetresPerUnit = units[unit];
    }
    if (name === "r") columns.ras = true;
    if (name === "defined") columns.placed = k;
    if (["name", "label", "landmark", "point"].includes(cell.toLowerCase())) columns.name = k;
  });
  if (columns.xyz.includes(-1)) return undefined;
  if (columns.name < 0 && cells.length > 3) columns.name = columns.xyz[0] === 0 ? 3 : 0;
  if (columns.name < 0) throw new Error("no column has the names of the points");
  return columns;
}

/** A table of names and coordinates (.csv, .tsv, .txt). */
export function parseTable(text: string): LandmarkList {
  const list: LandmarkList = { points: [] };
  let columns: Columns | undefined;
  let separator = ",";
  const toNumber = (cell: string | undefined): number =>
    cell === undefined || cell === "" ? NaN : Number(separator === "," ? cell : cell.replace(",", "."));
  linesOf(text).forEach((line, index) => {
    if (line.trim() === "" || line.startsWith("#")) return;
    if (columns === undefined) separator = ["\t", ";"].find((s) => line.includes(s)) ?? ",";
    const cells = cellsOf(line, separator);
    if (columns === undefined) {
      columns = readHeading(cells);
      if (columns !== undefined) return;
      const name = cells.findIndex((cell) => Number.isNaN(toNumber(cell)));
      if (cells.length < 4 || name < 0) throw new Error(`line ${index + 1} is no name and three coordinates`);
      const first = name >= 3 ? name - 3 : name + 1;
      columns = { name, xyz: [first, first + 1, first + 2], placed: -1, ras: false };
    }
    const label = cells[columns.name];
    if (!label || ["0", "false"].includes(cells[columns.placed]?.toLowerCase())) return;
    const at = columns.xyz.map((k) => toNumber(cells[k])) as Point;
    if (at.some((value) => !Number.isFinite(value)))
      throw new Error(`line ${index + 1}: ${label} has no three numbers`);
    list.points.push([label, turned(columns.ras, at)]);
  });
  list.millimetresPerUnit = columns?.millimetresPerUnit;
  list.wasRas = columns?.ras;
  return list;
}

/** Landmarks in millimetres and LPS as markups of 3D Slicer. */
export function writeMarkups(points: [string, Point][]): string {
  const controlPoints = points.map(([label, position], k) => ({
    id: `${k + 1}`,
    label,
    description: "",
    associatedNodeID: "",
    position,
    orientation: [-1, 0, 0, 0, -1, 0, 0, 0, 1],
    selected: true,
    locked: false,
    visibility: true,
    positionStatus: "defined",
  }));
  const schema = "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/";
  const markup = {
    type: "Fiducial",
    coordinateSystem: "LPS",
    coordinateUnits: "mm",
    locked: false,
    fixedNumberOfControlPoints: false,
    labelFormat: "%N-%d",
    lastUsedControlPointNumber: points.length,
    controlPoints,
  };
  return `${JSON.stringify({ "@schema": `${schema}markups-schema-v1.0.3.json#`, markups: [markup] }, null, 1)}\n`;
}
