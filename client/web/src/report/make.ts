// Reports of the plan as it is, made by whoever serves this page.
import { toJson } from "@bufbuild/protobuf";
import { signal } from "@preact/signals";
import { PlanSchema } from "@wire/plan_pb";
import { Retention_Preset } from "@wire/forecast_service_pb";
import { attempt } from "../activity";
import { token } from "../api/client";
import type { Mesh } from "../api/meshes";
import { asked, forecast, forecastIsOld } from "../forecast/state";
import { patientName, plan, scanMesh } from "../plan/state";
import { surfaceObj } from "../run/exports";
import { planText, target, targetMesh } from "../target/state";

export interface Report {
  html: string;
  csv: string;
  json: string;
  /** base64; absent where it could not be printed */
  pdf?: string;
}

export const settings = signal({ language: "en", paper: "a4" });
/** with the plan that it is of */
export const report = signal<{ of: Report; planText: string; name: string } | undefined>(undefined);
/** undefined: not known yet */
export const offered = signal<boolean | undefined>(undefined);

export async function askWhetherOffered(): Promise<void> {
  if (offered.value !== undefined) return;
  try {
    const answer = await fetch("./report");
    offered.value = answer.ok && (answer.headers.get("content-type") ?? "").startsWith("application/json");
  } catch {
    // The next look asks again.
  }
}

const objOf = (mesh: Mesh | undefined): string | undefined => mesh && surfaceObj(mesh.points, mesh.cells, mesh.corners);

const retentionWords: Record<Retention_Preset, string> = {
  [Retention_Preset.PRESET_UNSPECIFIED]: "pooled",
  [Retention_Preset.POOLED]: "pooled",
  [Retention_Preset.ACQUIRED_ATROPHY]: "acquired_atrophy",
  [Retention_Preset.MIXED_INDICATIONS]: "mixed_indications",
  [Retention_Preset.COTTON_PAD]: "cotton_pad",
  [Retention_Preset.CENTRIFUGE]: "centrifuge",
};

/** A forecast that was made for this plan is in it, with the same cases. */
export function orderOf(): object {
  const hasForecast = forecast.value !== undefined && !forecastIsOld.value;
  return {
    plan: toJson(PlanSchema, plan.value),
    face: objOf(scanMesh.value),
    goal: target.value && objOf(targetMesh.value),
    pseudonym: patientName.value,
    ...settings.value,
    retention: retentionWords[asked.value.retention],
    members: hasForecast ? forecast.value!.members : undefined,
  };
}

/** Each line of an answer as it comes. */
async function* linesOf(body: ReadableStream<Uint8Array>): AsyncIterable<string> {
  const [reader, decoder] = [body.getReader(), new TextDecoder()];
  let rest = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    const lines = (rest + decoder.decode(value, { stream: true })).split("\n");
    rest = lines.pop()!;
    yield* lines;
  }
  if (rest !== "") yield rest;
}

export function makeReport(): Promise<boolean> {
  const [text, name] = [planText.value, plan.value.name || "plan"];
  report.value = undefined;
  return attempt(
    "Making the report",
    async (tell, left) => {
      const answer = await fetch("./report", {
        method: "POST",
        headers: {
          "content-type": "application/json",
          ...(token.value === "" ? {} : { authorization: `Bearer ${token.value}` }),
        },
        body: JSON.stringify(orderOf()),
        signal: left,
      });
      if (!answer.ok || answer.body === null) throw new Error((await answer.text()).trim());
      for await (const line of linesOf(answer.body)) {
        const now = JSON.parse(line) as { stage?: string; error?: string } & Partial<Report>;
        if (now.error !== undefined) throw new Error(now.error);
        if (now.stage !== undefined) tell(undefined, `Making the report: ${now.stage || "waiting"}`);
        if (now.html !== undefined) report.value = { of: now as Report, planText: text, name };
      }
      if (report.value === undefined) throw new Error("The report did not come: the connection was lost. Try again.");
    },
    true,
  );
}

/** As a file that a browser or a printer takes. */
export function pdfOf({ pdf }: Report): Blob | undefined {
  if (pdf === undefined) return undefined;
  return new Blob([Uint8Array.from(atob(pdf), (letter) => letter.charCodeAt(0))], { type: "application/pdf" });
}
