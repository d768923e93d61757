#include "client/cli/report_fetch.h"

#include <chrono>
#include <thread>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/run.h"
#include "client/cpp/errors.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/model_build.h"
#include "client/cpp/scan_upload.h"
#include "client/cpp/target_call.h"
#include "lipofill/v1/forecast_service.grpc.pb.h"
#include "lipofill/v1/patient_service.grpc.pb.h"
#include "lipofill/v1/planning_service.grpc.pb.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::ForecastService;
using v1::PatientService;
using v1::PlanningService;
using v1::SimulationService;

constexpr std::chrono::milliseconds kFollowPeriod(200);

/// The plan asks for what cannot be told of it; everything else that fails is an error of the
/// report.
bool cannot_be_told(const absl::Status& status) {
  return absl::IsFailedPrecondition(status);
}

double injected_ml(const v1::SimulationSpec& spec) {
  double total = 0.0;
  for (const v1::Injection& injection : spec.injections()) total += injection.volume_ml();
  return total;
}

}  // namespace

absl::Status ReportFetch::fetch() {
  for (const auto step :
       {&ReportFetch::take_plan, &ReportFetch::make_target, &ReportFetch::find_inputs, &ReportFetch::simulate_plan,
        &ReportFetch::forecast, &ReportFetch::estimate_retention, &ReportFetch::simulate_remaining,
        &ReportFetch::measure_target, &ReportFetch::list_delivery}) {
    if (auto status = (this->*step)(); !status.ok()) return status;
  }
  return absl::OkStatus();
}

void ReportFetch::clean_up() {
  for (const std::string& name : simulations_) {
    v1::DeleteSimulationRequest request;
    request.set_name(name);
    (void)ground_.connection().without_stop().call<SimulationService>(&SimulationService::Stub::DeleteSimulation,
                                                                      request);
  }
  simulations_.clear();
}

absl::Status ReportFetch::take_plan() {
  answers_.plan = ground_.plan().plan;
  answers_.model = ground_.model();
  answers_.plan.mutable_simulation()->set_model(answers_.model.name());
  const std::string& scan = answers_.model.spec().scan_region().scan();
  if (scan.empty()) return absl::OkStatus();
  v1::GetScanRequest request;
  request.set_name(scan);
  auto found = ground_.connection().call<PatientService>(&PatientService::Stub::GetScan, request);
  if (!found.ok()) return found.status();
  answers_.scan = *std::move(found);
  return absl::OkStatus();
}

/// The surface that becomes the target, on the daemon.
absl::StatusOr<std::string> ReportFetch::find_surface() {
  if (absl::StartsWith(options_.target, "patients/")) return options_.target;
  const auto scan = ground_.send_surface(options_.target, options_.target_unit, "target");
  if (!scan.ok()) return scan.status();
  return scan->name();
}

absl::Status ReportFetch::make_target() {
  if (options_.target.empty() && options_.healthy.empty()) return absl::OkStatus();
  std::string surface;
  if (!options_.target.empty()) {
    auto found = find_surface();
    if (!found.ok()) return found.status();
    surface = *std::move(found);
  }
  const v1::ScanRegion& region = answers_.model.spec().scan_region();
  target_scan_ = surface;
  if (answers_.scan) {
    v1::MakeTargetRequest request;
    request.set_parent(ground_.patient());
    v1::TargetSpec& spec = *request.mutable_spec();
    spec.set_scan(region.scan());
    *spec.mutable_landmarks_mm() = region.landmarks_mm();
    if (surface.empty()) {
      spec.mutable_mirrored()->set_healthy_side(options_.healthy == "left" ? v1::LEFT : v1::RIGHT);
    } else {
      spec.mutable_surface()->set_scan(surface);
      if (options_.in_place) spec.mutable_surface()->set_placement(v1::FaceSurface::IN_PLACE);
    }
    if (!options_.target_landmarks.empty()) {
      const auto landmarks = load_landmarks(options_.target_landmarks, options_.target_unit);
      if (!landmarks.ok()) return landmarks.status();
      set_landmarks(*landmarks, spec.mutable_surface()->mutable_landmarks_mm());
    }
    const auto target =
        client::make_target(ground_.connection(), request, [this](const std::string& stage, double fraction) {
          progress_.show(absl::StrFormat("target: %.0f %%  %s", 100.0 * fraction, stage));
        });
    if (!target.ok()) return target.status();
    target_scan_ = target->scan();
  }
  v1::GetScanRequest request;
  request.set_name(target_scan_);
  auto scan = ground_.connection().call<PatientService>(&PatientService::Stub::GetScan, request);
  if (!scan.ok()) return scan.status();
  answers_.target = *std::move(scan);
  return absl::OkStatus();
}

/// Finds how near the shapes come to the target, and what the face lacks before.
absl::Status ReportFetch::measure_target() {
  if (!answers_.target) return absl::OkStatus();
  progress_.show("measuring distances to the target");
  for (ReportedShape* shape : {&answers_.planned, &answers_.remaining}) {
    v1::EvaluateSimulationRequest request;
    request.set_name(shape->simulation.name());
    request.set_target_scan(target_scan_);
    auto evaluation = ground_.connection().call<SimulationService>(&SimulationService::Stub::EvaluateSimulation,
                                                                   request, Connection::kCreationTimeout);
    if (!evaluation.ok()) return evaluation.status();
    shape->evaluation = *std::move(evaluation);
  }
  auto target_mesh = download_scan_mesh(ground_.connection(), target_scan_);
  if (!target_mesh.ok()) return target_mesh.status();
  target_mesh_ = *std::move(target_mesh);
  if (!answers_.scan) return absl::OkStatus();
  const v1::ScanRegion& region = answers_.model.spec().scan_region();
  v1::MeasureDeficitRequest request;
  request.set_scan(region.scan());
  *request.mutable_landmarks_mm() = region.landmarks_mm();
  request.set_target_scan(target_scan_);
  auto deficit = measure_deficit(ground_.connection(), request);
  if (!deficit.ok()) return deficit.status();
  answers_.deficit = *std::move(deficit);
  auto scan_mesh = download_scan_mesh(ground_.connection(), region.scan());
  if (!scan_mesh.ok()) return scan_mesh.status();
  scan_mesh_ = *std::move(scan_mesh);
  return absl::OkStatus();
}

v1::MakeForecastRequest ReportFetch::forecast_request() const {
  v1::MakeForecastRequest request;
  request.set_parent(ground_.patient());
  *request.mutable_spec() = spec_;
  *request.mutable_spec()->mutable_plan() = answers_.plan.simulation();
  request.mutable_spec()->set_figures_only(true);
  return request;
}

/// Asks what is uncertain of the plan, with its sources: a request that is only checked tells it.
absl::Status ReportFetch::find_inputs() {
  v1::MakeForecastRequest request = forecast_request();
  request.set_validate_only(true);
  const auto checked = ground_.connection().call<ForecastService>(&ForecastService::Stub::MakeForecast, request);
  if (cannot_be_told(checked.status())) {
    answers_.no_forecast = std::string(checked.status().message());
    return absl::OkStatus();
  }
  if (!checked.ok()) return checked.status();
  v1::Forecast inputs;
  if (!checked->response().UnpackTo(&inputs)) return absl::InternalError("the daemon checked something else");
  answers_.inputs.assign(inputs.inputs().begin(), inputs.inputs().end());
  return absl::OkStatus();
}

absl::Status ReportFetch::simulate_plan() {
  return settle(answers_.plan.simulation(), "plan", answers_.planned, planned_);
}

absl::Status ReportFetch::forecast() {
  if (options_.no_forecast) {
    answers_.no_forecast.clear();
    return absl::OkStatus();
  }
  if (!answers_.no_forecast.empty()) return absl::OkStatus();
  const auto operation =
      ground_.connection().call<ForecastService>(&ForecastService::Stub::MakeForecast, forecast_request());
  if (!operation.ok()) return operation.status();
  v1::Forecast forecast;
  const absl::Status finished = finish_operation(
      ground_.connection(), *operation,
      [this](const std::string& stage, double fraction) {
        progress_.show(absl::StrFormat("forecasting: %.0f %%  %s", 100.0 * fraction, stage));
      },
      &forecast);
  if (cannot_be_told(finished)) {
    answers_.no_forecast = std::string(finished.message());
    return absl::OkStatus();
  }
  if (finished.ok()) answers_.forecast = std::move(forecast);
  return finished;
}

absl::Status ReportFetch::estimate_retention() {
  if (answers_.forecast) {
    answers_.retention = answers_.forecast->retention();
    return absl::OkStatus();
  }
  v1::EstimateRetentionRequest request;
  *request.mutable_retention() = spec_.retention();
  *request.mutable_months() = spec_.months();
  if (spec_.has_follow_up()) {
    *request.mutable_follow_up() = spec_.follow_up();
    request.set_injected_ml(injected_ml(answers_.plan.simulation()));
  }
  auto estimate = ground_.connection().call<ForecastService>(&ForecastService::Stub::EstimateRetention, request);
  if (!estimate.ok()) return estimate.status();
  answers_.retention = *std::move(estimate);
  return absl::OkStatus();
}

absl::Status ReportFetch::simulate_remaining() {
  v1::SimulationSpec spec = answers_.plan.simulation();
  const double share = last_month_of(answers_.retention).p50();
  for (v1::Injection& injection : *spec.mutable_injections()) injection.set_volume_ml(share * injection.volume_ml());
  return settle(spec, "fat that is left", answers_.remaining, remaining_);
}

absl::Status ReportFetch::settle(const v1::SimulationSpec& spec, const std::string& what, ReportedShape& shape,
                                 FinalState& state) {
  v1::CreateSimulationRequest request;
  request.set_display_name(display_name_of(answers_.plan.name()));
  *request.mutable_spec() = spec;
  aim_at_settled_shape(*request.mutable_spec()->mutable_time());
  request.set_start(true);
  progress_.show(absl::StrCat("setting up the simulation of the ", what));
  auto simulation = ground_.connection().call<SimulationService>(&SimulationService::Stub::CreateSimulation, request,
                                                                 Connection::kCreationTimeout);
  if (!simulation.ok()) return simulation.status();
  simulations_.push_back(simulation->name());
  if (auto status = follow(*simulation, what); !status.ok()) return status;
  auto found = final_state(ground_.connection(), *simulation, {answers_.scan ? "scan" : "skin"});
  if (!found.ok()) return found.status();
  state = *std::move(found);
  shape.simulation = *std::move(simulation);
  return absl::OkStatus();
}

absl::Status ReportFetch::follow(v1::Simulation& simulation, const std::string& what) {
  while (!has_ended(simulation.state())) {
    progress_.show(absl::StrFormat("simulating the %s: %.1f s", what, simulation.summary().time_s()));
    std::this_thread::sleep_for(kFollowPeriod);
    auto now = get_simulation(ground_.connection(), simulation.name());
    if (!now.ok()) return now.status();
    simulation = *std::move(now);
  }
  if (simulation.state() == v1::Simulation::SETTLED || simulation.state() == v1::Simulation::FINISHED) {
    return absl::OkStatus();
  }
  return absl::FailedPreconditionError(absl::StrCat("the simulation of the ", what, " is ",
                                                    v1::Simulation::State_Name(simulation.state()), ": ",
                                                    simulation.reason()));
}

absl::Status ReportFetch::list_delivery() {
  progress_.show("listing the passes");
  v1::PlanDeliveryRequest request;
  *request.mutable_plan() = answers_.plan.simulation();
  auto delivery = ground_.connection().call<PlanningService>(&PlanningService::Stub::PlanDelivery, request);
  if (cannot_be_told(delivery.status()) || absl::IsInvalidArgument(delivery.status())) {
    answers_.no_delivery = error_text(delivery.status());
    return absl::OkStatus();
  }
  if (!delivery.ok()) return delivery.status();
  answers_.delivery = *std::move(delivery);
  return absl::OkStatus();
}

}  // namespace lipofill::client
