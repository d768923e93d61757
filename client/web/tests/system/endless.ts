// A small simulation that goes on, for tests of what watches it.
import { create } from "@bufbuild/protobuf";
import { createClient, type Transport } from "@connectrpc/connect";
import { ModelSpecSchema } from "@wire/model_pb";
import { OperationService } from "@wire/operation_service_pb";
import { PatientService } from "@wire/patient_service_pb";
import { SimulationSpecSchema } from "@wire/simulation_pb";
import { SimulationService } from "@wire/simulation_service_pb";

const square = create(ModelSpecSchema, {
  geometry: { case: "square", value: { lengthXiMm: 40, lengthEtaMm: 40 } },
  nXi: 24,
  nEta: 24,
  layers: [
    {
      name: "skin",
      thicknessMm: { kind: { case: "constant", value: 2 } },
      youngsModulusKpa: 100,
      poissonRatio: 0.45,
      densityKgM3: 1100,
    },
  ],
  rim: { kind: 1 },
  base: { kind: 1 },
});
const film = {
  name: "film",
  belowLayer: "skin",
  nXi: 12,
  nEta: 12,
  zones: [{ name: "all", shape: { case: "box" as const, value: { xiMin: 0, xiMax: 1, etaMin: 0, etaMax: 1 } } }],
};

/** A simulation that goes on until it is stopped. */
export async function startEndless(transport: Transport): Promise<string> {
  const patients = createClient(PatientService, transport);
  const { name: parent } = await patients.createPatient({ requestId: `p${Date.now()}` });
  let operation = await patients.buildModel({ parent, spec: square });
  const operations = createClient(OperationService, transport);
  while (!operation.done) operation = await operations.waitOperation({ name: operation.name });
  const { models } = await patients.listModels({ parent });
  const spec = create(SimulationSpecSchema, {
    model: models[0].name,
    films: [film],
    injections: [{ zone: "all", volumeMl: 0.4, rateMlPerS: 0.1 }],
    time: { stepMs: 10, endS: 100_000, settleSkinSpeedMmPerS: 0 },
  });
  const simulations = createClient(SimulationService, transport);
  return (await simulations.createSimulation({ spec, start: true })).name;
}
