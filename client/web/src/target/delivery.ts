// The list by which a plan's volumes are laid by hand.
import { create } from "@bufbuild/protobuf";
import { signal } from "@preact/signals";
import { PlanDeliveryRequestSchema, type CannulaPass, type Delivery } from "@wire/planning_service_pb";
import { attempt } from "../activity";
import { planning } from "../api/client";
import { toProblem } from "../api/errors";
import { simulationSpec } from "../plan/actions";
import { editPlan, violations } from "../plan/state";
import { delivery, planText } from "./state";

export const settings = signal({
  maxPassMl: undefined as number | undefined,
  tunnelSpacingMm: undefined as number | undefined,
  compare: false,
});

export function makeDelivery(): Promise<boolean> {
  violations.value = [];
  const text = planText.value;
  return attempt(
    settings.value.compare ? "Comparing the list with the plan" : "Making the list",
    async (_, left) => {
      try {
        const request = create(PlanDeliveryRequestSchema, { plan: simulationSpec(), ...settings.value });
        const list = await planning.planDelivery(request, { signal: left });
        if (planText.value === text) delivery.value = { list, planText: text };
      } catch (error) {
        violations.value = toProblem(error).violations.map(({ field, description }) => ({
          field: field
            .replace(/^plan(?=\.|$)/, "simulation")
            .replace(/^(max_pass_ml|tunnel_spacing_mm)$/, "delivery.$1"),
          description,
        }));
        throw error;
      }
    },
    true,
  );
}

/** The plan lays fat along the tunnels of the list from now on. */
export function takeAsGiven(): void {
  const { list } = delivery.value!;
  editPlan((next) => {
    next.simulation = list.planAsGiven;
    next.simulation!.model = "";
  });
}

export interface Tunnel {
  entry: number;
  tunnel: number;
  passes: CannulaPass[];
  volumeMl: number;
}

/** Passes of one tunnel together, in the order in which they are made. */
export function tunnelsOf({ passes }: Delivery): Tunnel[] {
  const tunnels: Tunnel[] = [];
  for (const pass of passes) {
    let last = tunnels.at(-1);
    if (last?.entry !== pass.entry || last.tunnel !== pass.tunnel) {
      last = { entry: pass.entry, tunnel: pass.tunnel, passes: [], volumeMl: 0 };
      tunnels.push(last);
    }
    last.passes.push(pass);
    last.volumeMl += pass.volumeMl;
  }
  return tunnels;
}

/** The list as a table for a spreadsheet, a pass a line. */
export function writeDelivery({ entries, passes }: Delivery): string {
  const lines = passes.map(({ entry, tunnel, volumeMl, pathMm }, index) => {
    const { zone, belowLayer } = entries[entry];
    const ends = [pathMm[0], pathMm.at(-1)].flatMap((at) =>
      [at?.x, at?.y, at?.z].map((value) => (value ?? 0).toFixed(2)),
    );
    return [index + 1, entry + 1, zone, belowLayer, tunnel + 1, volumeMl.toFixed(4), ...ends].join(",");
  });
  const head = "pass,entry,zone,below_layer,tunnel,volume_ml,from_x_mm,from_y_mm,from_z_mm,to_x_mm,to_y_mm,to_z_mm";
  return `${[head, ...lines].join("\n")}\n`;
}
