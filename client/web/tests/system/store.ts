// What the daemon has, asked by the command line.
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { bin, type System } from "./system";

function ask<T>(system: System, ...words: string[]): T {
  const server = `127.0.0.1:${system.daemonPort}`;
  return JSON.parse(String(execFileSync(join(bin, "lipofill"), [...words, "--json", "--server", server]))) as T;
}

interface Named {
  name: string;
  displayName: string;
}

export const listPatients = (system: System): Named[] =>
  (ask<{ patients?: (Named & { display_name?: string })[] }>(system, "patient", "list").patients ?? []).map(
    ({ name, displayName, display_name }) => ({ name, displayName: displayName ?? display_name ?? "" }),
  );

export const listScans = (system: System, patient: string): Named[] =>
  ask<{ scans?: Named[] }>(system, "scan", "list", patient).scans ?? [];

interface Plan {
  name: string;
  revision: string;
  content: { simulation: { injections: { volume_ml: number }[] } };
  runs: { simulation: string }[];
}

export const listPlans = (system: System): Plan[] => ask<{ plans?: Plan[] }>(system, "plan", "list").plans ?? [];

export const showPlan = (system: System, name: string): Plan => ask<Plan>(system, "plan", "show", name);
