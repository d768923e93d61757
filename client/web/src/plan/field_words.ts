// Names of the plan's fields in the words of the page: which zone, which injection, which layer.
import type { Plan } from "@wire/plan_pb";
import { readable } from "./anatomy";

/** Words of single fields; others are their names without underscores and units. */
const words: Record<string, string> = {
  films: "plane",
  n_xi: "resolution",
  n_eta: "resolution",
  below_layer: "layer that the fat goes under",
  scan_region: "part of the face",
  landmarks_mm: "landmarks",
  end_s: "end of the simulation",
  rest_thickness_mm: "thin film at rest",
  scan: "scan",
  site: "point of delivery",
  place: "place",
  youngs_modulus_kpa: "Young's modulus",
  wall: "wall",
  edge: "tissue around the zones",
  base: "what lies beneath the tissue",
  rim: "edge of the model",
  bounds: "bounds",
  spread: "cases of tissue",
};

const units = /_(ml_per_s_kpa_cm|ml_per_s|kpa_per_mm|pa_s_n|pa_s|mm_per_s|kg_m3|m_s2|n_per_mm|ml|kpa|pa|mm|ms|s|n)$/;

function listWord(plan: Plan, path: string, list: string, index: number): string {
  const { model, simulation } = plan;
  const film = Number(/films\[(\d+)\]/.exec(path)?.[1] ?? 0);
  const named = (kind: string, name: string | undefined): string =>
    name ? `${kind} ${readable(name)}` : `${kind} ${index + 1}`;
  switch (list) {
    case "films":
      return named("plane under", simulation?.films[index]?.belowLayer);
    case "zones":
      return named("zone", simulation?.films[film]?.zones[index]?.name);
    case "walls":
      return named("wall", simulation?.films[film]?.walls[index]?.name);
    case "ligaments":
      return named("ligament", simulation?.ligaments[index]?.name);
    case "layers":
      return named("layer", model?.layers[index]?.name);
    case "injections":
      return `injection ${index + 1}`;
    case "corners":
      return `corner ${index + 1}`;
    default:
      return `${list.replace(/_/g, " ")} ${index + 1}`;
  }
}

function wordOf(plan: Plan, path: string, part: string): string {
  const list = /^(\w+)\[(\d+)\]$/.exec(part);
  if (list) return listWord(plan, path, list[1], Number(list[2]));
  return words[part] ?? part.replace(units, "").replace(/_/g, " ");
}

/**
 * "simulation.films[0].zones[1].disc.radius_mm" as "Radius of zone Masseter".
 * The innermost name that people know stands last, what contains it only where it is not clear.
 */
export function fieldWords(field: string, plan: Plan): string {
  const parts = field.split(".").filter((part) => !["simulation", "model", "spec", "plan", "proposal"].includes(part));
  const at = parts.map((part) => part.includes("[")).lastIndexOf(true);
  const inner = parts.slice(at + 1).filter((part) => !["disc", "attachment", "scan_region"].includes(part));
  const owner = at < 0 ? "" : wordOf(plan, field, parts[at]);
  const last =
    inner.length > 0
      ? wordOf(plan, field, inner.at(-1)!)
      : at < 0
        ? wordOf(plan, field, parts.at(-1) ?? field.split(".").at(-1)!)
        : "";
  const text = owner === "" ? last : last === "" ? owner : `${last} of ${owner}`;
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** Zones and layers of the plan by the names that the page shows. */
function readableNames(text: string, { model, simulation }: Plan): string {
  const names = [
    ...(simulation?.films ?? []).flatMap(({ zones }) => zones.map(({ name }) => name)),
    ...(model?.layers ?? []).map(({ name }) => name),
  ];
  return names
    .filter((name) => name.includes("_"))
    .reduce((said, name) => said.replaceAll(name, readable(name).toLowerCase()), text);
}

const files = /\.(obj|ply|stl|json|csv)$/;

/** "scan_region.bone_scan" as "bone scan", a region by its name; names of files stay. */
function schemaWord(path: string, plan: Plan): string {
  if (files.test(path)) return path;
  const last = path.split(".").at(-1)!;
  return /_(left|right)$/.test(last) ? readable(last).toLowerCase() : wordOf(plan, path, last);
}

/**
 * What the daemon says, without the names of its schema and the coordinates of its chart. The page
 * calls a target a goal.
 */
export function plainWords(description: string, plan: Plan): string {
  return readableNames(description, plan)
    .replace(/\btarget\b/g, "goal")
    .replace(/\bTarget\b/g, "Goal")
    .replace(/lies at \([^)]*\)(?: of the chart)?,?/g, "lies")
    .replace(/ at \([-\d.e]+, [-\d.e]+\)(?: of the chart)?/g, "")
    .replace(/\b(?:spec|simulation|model|plan)(?:\.\w+(?:\[\d+\])?)+/g, (path) => {
      const words = fieldWords(path.replace(/^spec\./, ""), plan);
      return words.charAt(0).toLowerCase() + words.slice(1);
    })
    .replace(/\b(?:films|zones|injections|layers|ligaments|walls)\[\d+\](?:\.\w+(?:\[\d+\])?)*/g, (path) => {
      const words = fieldWords(path, plan);
      return words.charAt(0).toLowerCase() + words.slice(1);
    })
    .replace(/\b[a-z0-9_]*_[a-z0-9_]*(?:\.[a-z0-9_]+)*\b/g, (path) => schemaWord(path, plan));
}

/** With a capital letter and an end. */
export function sentence(text: string): string {
  const first = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}
