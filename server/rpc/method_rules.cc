#include "server/rpc/method_rules.h"

#include <map>

namespace lipofill::server {
namespace {

const std::map<std::string, Effect>& rules() {
  static const std::map<std::string, Effect> rules = {
      {"/grpc.health.v1.Health/Check", Effect::kNone},
      {"/grpc.health.v1.Health/Watch", Effect::kNone},
      {"/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", Effect::kNone},
      {"/lipofill.v1.FrameService/AcknowledgeFrame", Effect::kSteers},
      {"/lipofill.v1.FrameService/Watch", Effect::kBegins},
      {"/lipofill.v1.OperationService/CancelOperation", Effect::kSteers},
      {"/lipofill.v1.OperationService/GetOperation", Effect::kNone},
      {"/lipofill.v1.OperationService/ListOperations", Effect::kNone},
      {"/lipofill.v1.OperationService/WaitOperation", Effect::kNone},
      {"/lipofill.v1.PatientService/BuildModel", Effect::kBegins},
      {"/lipofill.v1.PatientService/CreatePatient", Effect::kBegins},
      {"/lipofill.v1.PatientService/CreateScan", Effect::kBegins},
      {"/lipofill.v1.PatientService/DeleteModel", Effect::kSteers},
      {"/lipofill.v1.PatientService/DeletePatient", Effect::kSteers},
      {"/lipofill.v1.PatientService/DeleteScan", Effect::kSteers},
      {"/lipofill.v1.PatientService/DownloadModelMesh", Effect::kNone},
      {"/lipofill.v1.PatientService/DownloadScanMesh", Effect::kNone},
      {"/lipofill.v1.PatientService/GetModel", Effect::kNone},
      {"/lipofill.v1.PatientService/GetPatient", Effect::kNone},
      {"/lipofill.v1.PatientService/GetScan", Effect::kNone},
      {"/lipofill.v1.PatientService/ListModels", Effect::kNone},
      {"/lipofill.v1.PatientService/ListPatients", Effect::kNone},
      {"/lipofill.v1.PatientService/ListScans", Effect::kNone},
      {"/lipofill.v1.PatientService/UpdatePatient", Effect::kSteers},
      {"/lipofill.v1.PatientService/UploadScan", Effect::kBegins},
      {"/lipofill.v1.SimulationService/CreateCheckpoint", Effect::kBegins},
      {"/lipofill.v1.SimulationService/CreateSimulation", Effect::kBegins},
      {"/lipofill.v1.SimulationService/DeleteCheckpoint", Effect::kSteers},
      {"/lipofill.v1.SimulationService/DeleteSimulation", Effect::kSteers},
      {"/lipofill.v1.SimulationService/EvaluateSimulation", Effect::kNone},
      {"/lipofill.v1.SimulationService/ExportTissueDeck", Effect::kNone},
      {"/lipofill.v1.SimulationService/GetCheckpoint", Effect::kNone},
      {"/lipofill.v1.SimulationService/GetSeries", Effect::kNone},
      {"/lipofill.v1.SimulationService/GetSimulation", Effect::kNone},
      {"/lipofill.v1.SimulationService/Inject", Effect::kBegins},
      {"/lipofill.v1.SimulationService/ListCheckpoints", Effect::kNone},
      {"/lipofill.v1.SimulationService/ListSimulations", Effect::kNone},
      {"/lipofill.v1.SimulationService/PauseSimulation", Effect::kSteers},
      {"/lipofill.v1.SimulationService/RestoreSimulation", Effect::kBegins},
      {"/lipofill.v1.SimulationService/ResumeSimulation", Effect::kBegins},
      {"/lipofill.v1.SimulationService/StartSimulation", Effect::kBegins},
      {"/lipofill.v1.SimulationService/StopSimulation", Effect::kSteers},
  };
  return rules;
}

}  // namespace

Effect effect_of(const std::string& method) {
  const auto found = rules().find(method);
  return found == rules().end() ? Effect::kNone : found->second;
}

bool has_rule(const std::string& method) {
  return rules().contains(method);
}

}  // namespace lipofill::server
