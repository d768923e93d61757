#include "server/entry/method_rules.h"

#include <map>

namespace lipofill::server {
namespace {

constexpr MethodRule kOpen{Effect::kNone, Role::kNone, true};

const std::map<std::string, MethodRule>& rules() {
  static const std::map<std::string, MethodRule> rules = {
      {"/grpc.health.v1.Health/Check", kOpen},
      {"/grpc.health.v1.Health/Watch", kOpen},
      {"/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", kOpen},
      {"/lipofill.v1.ForecastService/EstimateRetention", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.ForecastService/MakeForecast", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.FrameService/AcknowledgeFrame", {Effect::kSteers, Role::kViewer, false, true}},
      {"/lipofill.v1.FrameService/Watch", {Effect::kBegins, Role::kViewer}},
      {"/lipofill.v1.OperationService/CancelOperation", {Effect::kSteers, Role::kPlanner}},
      {"/lipofill.v1.OperationService/GetOperation", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.OperationService/ListOperations", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.OperationService/WaitOperation", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PatientService/BuildModel", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.PatientService/CreatePatient", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.PatientService/CreateScan", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.PatientService/DeleteModel", {Effect::kSteers, Role::kPlanner, false, false, true}},
      {"/lipofill.v1.PatientService/DeletePatient", {Effect::kSteers, Role::kAdmin, false, false, true}},
      {"/lipofill.v1.PatientService/DeleteScan", {Effect::kSteers, Role::kPlanner, false, false, true}},
      {"/lipofill.v1.PatientService/DownloadModelMesh", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PatientService/DownloadScanMesh", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PatientService/GetModel", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PatientService/GetPatient", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PatientService/GetScan", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PatientService/ListModels", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PatientService/ListPatients", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PatientService/ListScans", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PatientService/UpdatePatient", {Effect::kSteers, Role::kPlanner}},
      {"/lipofill.v1.PatientService/UploadScan", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.PlanService/AddPlanRun", {Effect::kSteers, Role::kPlanner}},
      {"/lipofill.v1.PlanService/CreatePlan", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.PlanService/DeletePlan", {Effect::kSteers, Role::kPlanner, false, false, true}},
      {"/lipofill.v1.PlanService/GetPlan", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PlanService/GetPlanRevision", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PlanService/ListPlanRevisions", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PlanService/ListPlans", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PlanService/UpdatePlan", {Effect::kSteers, Role::kPlanner}},
      {"/lipofill.v1.PlanningService/ArrangeFace", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PlanningService/MakeTarget", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.PlanningService/MeasureDeficit", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.PlanningService/PlanDelivery", {Effect::kBegins, Role::kViewer}},
      {"/lipofill.v1.PlanningService/ProposePlan", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.SimulationService/CheckPlan", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.SimulationService/CreateCheckpoint", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.SimulationService/CreateSimulation", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.SimulationService/DeleteCheckpoint", {Effect::kSteers, Role::kPlanner, false, false, true}},
      {"/lipofill.v1.SimulationService/DeleteSimulation", {Effect::kSteers, Role::kPlanner, false, false, true}},
      {"/lipofill.v1.SimulationService/EvaluateSimulation", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.SimulationService/ExportTissueDeck", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.SimulationService/FindShape", {Effect::kBegins, Role::kViewer, false, true}},
      {"/lipofill.v1.SimulationService/GetCheckpoint", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.SimulationService/GetSeries", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.SimulationService/GetSimulation", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.SimulationService/Inject", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.SimulationService/ListCheckpoints", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.SimulationService/ListSimulations", {Effect::kNone, Role::kViewer}},
      {"/lipofill.v1.SimulationService/PauseSimulation", {Effect::kSteers, Role::kPlanner}},
      {"/lipofill.v1.SimulationService/RestoreSimulation", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.SimulationService/ResumeSimulation", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.SimulationService/StartSimulation", {Effect::kBegins, Role::kPlanner}},
      {"/lipofill.v1.SimulationService/StopSimulation", {Effect::kSteers, Role::kPlanner}},
  };
  return rules;
}

}  // namespace

const MethodRule* rule_of(const std::string& method) {
  const auto found = rules().find(method);
  return found == rules().end() ? nullptr : &found->second;
}

bool has_rule(const std::string& method) {
  return rule_of(method) != nullptr;
}

}  // namespace lipofill::server
