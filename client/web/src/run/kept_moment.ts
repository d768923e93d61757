// The frame that is looked at, kept in this tab: the daemon has the last frame of a run that is
// over, and a reload would lose every other. It has how far the skin moved, and not the face.
import type { WireArray } from "../api/arrays";
import type { Frame } from "../api/watch";
import { lookAt } from "./run";
import { store } from "./state";

const key = "lipofill.moment";
/** A tab has some 5 million characters for everything. */
const mostBytes = 1 << 20;
const nearS = 0.02;

interface KeptArray extends Omit<WireArray, "bytes"> {
  base64: string;
}
interface KeptFrame {
  run: string;
  epoch: string;
  sequence: string;
  timeS: number;
  fields: KeptArray[];
}

function toBase64(bytes: Uint8Array): string {
  const pieces: string[] = [];
  for (let at = 0; at < bytes.length; at += 8192) pieces.push(String.fromCharCode(...bytes.subarray(at, at + 8192)));
  return btoa(pieces.join(""));
}
const fromBase64 = (text: string): Uint8Array => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

/** Without a frame, or where a tab has no room for it, nothing is kept. */
export function keepMoment(run: string, frame: Frame | undefined): void {
  const arrays = [...(frame?.fields.values() ?? [])];
  const size = arrays.reduce((sum, { bytes }) => sum + bytes.byteLength, 0);
  if (!frame || run === "" || size > mostBytes) return sessionStorage.removeItem(key);
  const fields = arrays.map(({ bytes, ...rest }) => ({ ...rest, base64: toBase64(bytes) }));
  const kept: KeptFrame = { run, epoch: `${frame.epoch}`, sequence: `${frame.sequence}`, timeS: frame.timeS, fields };
  try {
    sessionStorage.setItem(key, JSON.stringify(kept));
  } catch {
    sessionStorage.removeItem(key);
  }
}

export function recallMoment(run: string, timeS: number): Frame | undefined {
  try {
    const kept = JSON.parse(sessionStorage.getItem(key) ?? "") as KeptFrame;
    if (kept.run !== run || Math.abs(kept.timeS - timeS) > nearS) return undefined;
    const fields = kept.fields.map(({ base64, ...rest }) => ({ ...rest, bytes: fromBase64(base64) }));
    return {
      epoch: BigInt(kept.epoch),
      sequence: BigInt(kept.sequence),
      timeS: kept.timeS,
      preview: false,
      end: false,
      fields: new Map(fields.map((field) => [field.name, field])),
    };
  } catch {
    return undefined; // nothing, or what another version of the page has kept
  }
}

/** Looks at a moment of the run on the page; whether there is a frame of it. */
export function goToMoment(run: string, timeS: number): boolean {
  const kept = recallMoment(run, timeS);
  if (kept) store.insert(kept);
  // An address has hundredths of a second: the frame may lie just behind what it says.
  const there = kept ?? store.at(timeS);
  if (there === undefined || Math.abs(there.timeS - timeS) > nearS) return false;
  lookAt(there.timeS);
  return true;
}
