// Asks for the forecast of the plan as it is.
import { create } from "@bufbuild/protobuf";
import { ForecastSchema, ForecastSpecSchema, RetentionSchema } from "@wire/forecast_service_pb";
import { attempt } from "../activity";
import { forecasts, newId } from "../api/client";
import { toProblem } from "../api/errors";
import { finish } from "../api/long_work";
import { simulationSpec } from "../plan/actions";
import { model, patient, violations } from "../plan/state";
import { planText } from "../target/state";
import { asked, forecastView, made, timeIndex } from "./state";

export async function makeForecast(): Promise<boolean> {
  violations.value = [];
  const [of, text] = [model.value?.name ?? "", planText.value];
  const { members, retention } = asked.value;
  return attempt(
    "Making the forecast",
    async (tell, left) => {
      try {
        const spec = create(ForecastSpecSchema, {
          plan: simulationSpec(),
          members,
          retention: create(RetentionSchema, { preset: retention }),
        });
        const found = await finish(
          await forecasts.makeForecast({ requestId: newId(), parent: patient.value, spec }),
          ForecastSchema,
          ({ fraction, stage }) => tell(fraction, `Making the forecast: ${stage}`),
          left,
        );
        if (model.value?.name !== of) return;
        made.value = { found, model: of, planText: text };
        [timeIndex.value, forecastView.value] = [0, "mean"];
      } catch (error) {
        violations.value = toProblem(error).violations.map(({ field, description }) => ({
          field: field.replace(/^spec\.plan(?=\.|$)/, "simulation").replace(/^spec(?=\.|$)/, "forecast"),
          description,
        }));
        throw error;
      }
    },
    true,
  );
}
