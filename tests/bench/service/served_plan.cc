#include "tests/bench/service/served_plan.h"

#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cpp/model_build.h"
#include "client/cpp/scan_upload.h"
#include "lipofill/v1/patient_service.grpc.pb.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::bench {

using v1::PatientService;
using v1::SimulationService;

absl::StatusOr<client::PlanFile> read_plan(const PlanOptions& options) {
  auto plan = client::load_plan(options.plan);
  if (!plan.ok()) return plan;
  if (!options.scan.empty()) plan->scan_file = options.scan;
  if (!options.landmarks.empty()) {
    plan->landmarks_file = options.landmarks;
    plan->plan.mutable_model()->mutable_scan_region()->clear_landmarks_mm();
    plan->plan.mutable_model()->mutable_scan_region()->clear_axes();
  }
  if (const absl::Status status = client::load_plan_landmarks(&*plan); !status.ok()) return status;
  return plan;
}

ServedPlan::ServedPlan(client::PlanFile plan, int workers)
    : plan_(std::move(plan)),
      daemon_(directory_.file("data"), {"--workers", absl::StrCat(workers), "--log-level", "warning"}),
      connection_(daemon_.address()) {}

absl::StatusOr<std::unique_ptr<ServedPlan>> ServedPlan::start(const client::PlanFile& plan, int workers,
                                                              const EndPhase& end_phase) {
  std::unique_ptr<ServedPlan> served(new ServedPlan(plan, workers));
  if (!served->daemon_.running()) return absl::UnavailableError("the daemon does not start");
  end_phase("starting the daemon");
  if (const absl::Status status = served->build(end_phase); !status.ok()) return status;
  return served;
}

absl::Status ServedPlan::build(const EndPhase& end_phase) {
  const auto patient =
      connection_.call<PatientService>(&PatientService::Stub::CreatePatient, v1::CreatePatientRequest());
  if (!patient.ok()) return patient.status();
  v1::BuildModelRequest request;
  request.set_parent(patient->name());
  *request.mutable_spec() = plan_.plan.model();
  if (plan_.scan_file) {
    const auto scan = client::upload_scan(connection_, patient->name(), *plan_.scan_file, plan_.plan.scan().unit());
    if (!scan.ok()) return scan.status();
    request.mutable_spec()->mutable_scan_region()->set_scan(scan->name());
    scan_triangles_ = static_cast<int>(scan->report().triangles());
    end_phase("sending the scan");
  }
  const auto model = client::build_model(connection_, request);
  if (!model.ok()) return model.status();
  model_ = model->name();
  end_phase("building the model");
  return absl::OkStatus();
}

std::vector<std::string> ServedPlan::meshes() const {
  std::vector<std::string> names = {"skin"};
  for (const v1::Film& film : plan_.plan.simulation().films()) names.push_back(absl::StrCat("film/", film.name()));
  if (plan_.scan_file) names.push_back("scan");
  return names;
}

absl::Status ServedPlan::create(const std::string& id, double simulated_s) {
  v1::CreateSimulationRequest request;
  request.set_simulation_id(id);
  *request.mutable_spec() = plan_.plan.simulation();
  request.mutable_spec()->set_model(model_);
  request.mutable_spec()->mutable_time()->set_end_s(simulated_s);
  request.mutable_spec()->mutable_time()->clear_max_step_ms();
  request.mutable_spec()->mutable_time()->set_settle_skin_speed_mm_per_s(0.0);
  return connection_
      .call<SimulationService>(&SimulationService::Stub::CreateSimulation, request,
                               client::Connection::kCreationTimeout)
      .status();
}

absl::Status ServedPlan::start(const std::string& id) {
  v1::StartSimulationRequest request;
  request.set_name("simulations/" + id);
  return connection_.call<SimulationService>(&SimulationService::Stub::StartSimulation, request).status();
}

absl::Status ServedPlan::remove(const std::string& id) {
  v1::DeleteSimulationRequest request;
  request.set_name("simulations/" + id);
  return connection_.call<SimulationService>(&SimulationService::Stub::DeleteSimulation, request).status();
}

absl::StatusOr<std::vector<v1::Simulation>> ServedPlan::list() const {
  const auto response =
      connection_.call<SimulationService>(&SimulationService::Stub::ListSimulations, v1::ListSimulationsRequest());
  if (!response.ok()) return response.status();
  return std::vector<v1::Simulation>(response->simulations().begin(), response->simulations().end());
}

absl::StatusOr<v1::Simulation> ServedPlan::get(const std::string& id) const {
  v1::GetSimulationRequest request;
  request.set_name("simulations/" + id);
  return connection_.call<SimulationService>(&SimulationService::Stub::GetSimulation, request);
}

absl::StatusOr<v1::Simulation> ServedPlan::await_end(const std::string& id) const {
  while (true) {
    auto simulation = get(id);
    if (!simulation.ok() || simulation->state() == v1::Simulation::FINISHED) return simulation;
    if (simulation->state() != v1::Simulation::RUNNING) {
      return absl::FailedPreconditionError(absl::StrCat(
          simulation->name(), " is ", v1::Simulation::State_Name(simulation->state()), ": ", simulation->reason()));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace lipofill::bench
