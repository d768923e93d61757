// Names that the daemon knows, and regions of skin that are cut as a whole.
import { create } from "@bufbuild/protobuf";
import { SkinPointSchema, type SkinPoint } from "@wire/geometry_pb";
import { AroundSchema, type Around } from "@wire/model_pb";
import type { Plan } from "@wire/plan_pb";

export type Side = "left" | "right";

export const landmarkNames = [
  "nasion",
  "pronasale",
  "subnasale",
  "pogonion",
  "menton",
  ...["exocanthion", "alare", "cheilion", "gonion", "zygion", "tragion"].flatMap((name) => [
    `${name}_left`,
    `${name}_right`,
  ]),
];

export const landmarkHints: Record<string, string> = {
  nasion: "root of the nose",
  pronasale: "tip of the nose",
  subnasale: "below the nose",
  pogonion: "front of the chin",
  menton: "lowest point of the chin",
  exocanthion: "outer corner of the eye",
  alare: "wing of the nose",
  cheilion: "corner of the mouth",
  gonion: "angle of the jaw",
  zygion: "widest point of the cheekbone",
  tragion: "notch above the tragus",
};

export const zoneNames = [
  "masseter",
  "mandibular_angle",
  "buccal",
  "malar",
  "zygomatic",
  "soof",
  "tear_trough",
  "midface",
  "nasolabial",
  "upper_lip",
  "lower_lip",
  "marionette",
  "chin",
  "jawline",
  "submaxillary",
  "temple",
  "forehead",
];
export const ligamentNames = [
  "zygomatic",
  "masseteric_cutaneous",
  "mandibular_osteocutaneous",
  "medial_mandibular",
  "mental",
];

interface Corner {
  weights: Record<string, number>;
  left: number;
  up: number;
  forward: number;
}

/** For the left side, anticlockwise seen from outside. */
const regions: Record<string, { label: string; corners: Corner[] }> = {
  jaw: {
    label: "Lower cheek and angle of the jaw",
    corners: [
      { weights: { gonion: 0.3, menton: 0.3, cheilion: 0.4 }, left: 11, up: -14, forward: 5 },
      { weights: { gonion: 1 }, left: -2, up: -17, forward: -12 },
      { weights: { zygion: 0.8, gonion: 0.2 }, left: 2, up: 1, forward: -10 },
      { weights: { zygion: 0.35, cheilion: 0.65 }, left: 8, up: 18, forward: 7 },
    ],
  },
  midface: {
    label: "Cheekbone and midface",
    corners: [
      { weights: { alare: 0.6, zygion: 0.4 }, left: 1, up: -28, forward: 14 },
      { weights: { alare: 0.2, zygion: 0.8 }, left: 9, up: -33, forward: -11 },
      { weights: { zygion: 1 }, left: -1, up: 11, forward: 2 },
      { weights: { exocanthion: 0.6, alare: 0.4 }, left: 8, up: -3, forward: -4 },
    ],
  },
};

/** Parts of the face that a model can be built around: named regions, without their side. */
const parts: Record<string, { label: string; zones: string[] }> = {
  jaw_zones: { label: "Masseter and angle of the jaw", zones: ["masseter", "mandibular_angle"] },
  cheek_zones: { label: "Cheek", zones: ["buccal", "malar"] },
  midface_zones: { label: "Midface and tear trough", zones: ["midface", "tear_trough"] },
  ...Object.fromEntries(zoneNames.map((name) => [name, { label: readable(name), zones: [name] }])),
};

export const regionLabels = [
  ...Object.entries(parts).map(([key, { label }]) => ({ key, label })),
  ...Object.entries(regions).map(([key, { label }]) => ({ key, label: `${label}, by four corners` })),
];

/** Whether a part of the face is cut between four corners, and not around its zones. */
export const isCornered = (key: string): boolean => key in regions;

/** What the model of a part of the face goes around. */
export function aroundOf(key: string, side: Side): Around {
  return create(AroundSchema, { regions: parts[key].zones.map((name) => `${name}_${side}`) });
}

/** Landmarks between both sides. */
export const midline = ["nasion", "pronasale", "subnasale", "pogonion", "menton"];
const sided = (name: string, side: Side): string => (midline.includes(name) ? name : `${name}_${side}`);

/** Landmarks without which a region cannot be placed. */
export function landmarksOf(region: string, side: Side): string[] {
  if (!isCornered(region)) return [];
  return [
    ...new Set(regions[region].corners.flatMap(({ weights }) => Object.keys(weights).map((name) => sided(name, side)))),
  ];
}

/**
 * The corners of a region on either side; the mirrored ones in the order that leaves them
 * anticlockwise.
 */
export function cornersOf(region: string, side: Side): SkinPoint[] {
  const corners = regions[region].corners.map((corner) =>
    create(SkinPointSchema, {
      place: {
        case: "landmarks",
        value: {
          weights: Object.fromEntries(
            Object.entries(corner.weights).map(([name, weight]) => [sided(name, side), weight]),
          ),
          leftMm: side === "left" ? corner.left : -corner.left,
          upMm: corner.up,
          forwardMm: corner.forward,
        },
      },
    }),
  );
  return side === "left" ? corners : [corners[1], corners[0], corners[3], corners[2]];
}

/**
 * Lets the region follow from the zones of a plan that gives it neither corners nor what it goes
 * around.
 */
export function takeRegionFromZones({ model, simulation }: Plan): void {
  if (model?.geometry.case !== "scanRegion") return;
  const into = model.geometry.value;
  if (into.corners.length > 0 || into.around) return;
  const names = (simulation?.films ?? []).flatMap(({ zones }) =>
    zones.flatMap(({ shape }) => (shape.case === "region" ? [shape.value] : [])),
  );
  if (names.length > 0) into.around = create(AroundSchema, { regions: [...new Set(names)] });
}

/** "mandibular_angle_left" for people. */
export function readable(name: string): string {
  const text = name
    .replace(/_(left|right)$/, ", $1")
    .replace(/_/g, " ")
    .replace(/\b(soof|smas)\b/g, (short) => short.toUpperCase());
  return text.charAt(0).toUpperCase() + text.slice(1);
}
