// What the picture shows, and how.
import { signal } from "@preact/signals";
import type { ColourMap, Quantity } from "../scene/colour_maps";
import type { FaceScene, Probe } from "../scene/face_scene";

export type Compare = "after" | "side" | "slider";
export type Step = "face" | "goal" | "tissue" | "fat" | "run";
export const stepNames: Step[] = ["face", "goal", "tissue", "fat", "run"];

export const step = signal<Step>("face");
export const quantity = signal<Quantity | "none">("displacement");
export const compare = signal<Compare>("after");
/** for the patient to look at: the face, and no forms */
export const presenting = signal(false);
/** dark around the face, for a dim room */
export const dark = signal(false);
/** the face has the colours that the scan has, where it has some */
export const ownColours = signal(true);
export const showRulers = signal(false);
/** names of landmarks on the face */
export const showLabels = signal(true);
/** share of the picture that shows the face before */
export const split = signal(0.5);
export const map = signal<ColourMap | undefined>(undefined);
export const probe = signal<(Probe & { x: number; y: number }) | undefined>(undefined);
/** where a tool is when the keyboard leads it, in pixels of the picture */
export const keyCursor = signal<{ x: number; y: number } | undefined>(undefined);
/** how far the skin under the cursor is from the goal */
export const goalProbe = signal<{ toGoalMm: number; x: number; y: number } | undefined>(undefined);
export const shownScene = signal<FaceScene | undefined>(undefined);
/** pictures of different frames, in the last second and in all */
export const rate = signal(0);
