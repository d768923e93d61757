#include "client/cli/run.h"

#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "client/cli/describe.h"
#include "client/cli/listing.h"
#include "client/cli/picture.h"
#include "client/cli/result_files.h"
#include "client/cli/simulation_calls.h"
#include "client/cpp/errors.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/model_build.h"
#include "client/cpp/result_text.h"
#include "client/cpp/scan_upload.h"
#include "lipofill/v1/patient_service.grpc.pb.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::PatientService;
using v1::SimulationService;

constexpr char kPrivateData[] = ".lipofilld";

/// The settled shape in as few steps as it takes: the goal's own step lengths and tolerance in
/// place of the plan's.
void aim_at_settled_shape(v1::TimeControl& time) {
  time.set_goal(v1::TimeControl::SETTLED_SHAPE);
  time.clear_max_step_ms();
  time.clear_max_injection_step_ms();
  time.clear_error_tolerance_mm();
}

}  // namespace

Run::Run(Application& application, RunOptions options)
    : application_(application), options_(std::move(options)), progress_(options_.quiet), folder_(options_.out) {}

absl::StatusOr<ExitCode> Run::carry_out() {
  absl::Status status;
  for (const auto step : {&Run::read_plan, &Run::reach_daemon, &Run::prepare_patient, &Run::send_scan, &Run::build,
                          &Run::create_simulation, &Run::simulate, &Run::write_results, &Run::evaluate}) {
    status = (this->*step)();
    if (!status.ok()) break;
  }
  progress_.finish();
  if (status.ok() && options_.picture) draw();
  clean_up();
  if (!status.ok()) return status;
  print_summary();
  return exit_code();
}

absl::Status Run::read_plan() {
  auto plan = load_plan(options_.plan);
  if (!plan.ok()) return plan.status();
  plan_ = *std::move(plan);
  if (!options_.scan.empty()) plan_.scan_file = options_.scan;
  if (!options_.bone.empty()) plan_.bone_file = options_.bone;
  if (!options_.landmarks.empty()) {
    plan_.landmarks_file = options_.landmarks;
    plan_.plan.mutable_model()->mutable_scan_region()->clear_landmarks_mm();
    plan_.plan.mutable_model()->mutable_scan_region()->clear_axes();
  }
  if (options_.unit) {
    plan_.plan.mutable_scan()->set_unit(*options_.unit);
    if (!options_.bone.empty()) plan_.plan.mutable_bone()->set_unit(*options_.unit);
  }
  if (options_.interval_ms) plan_.plan.mutable_output()->set_interval_ms(*options_.interval_ms);
  if (options_.preview) plan_.plan.mutable_simulation()->set_preview(true);
  if (options_.fast) aim_at_settled_shape(*plan_.plan.mutable_simulation()->mutable_time());
  if (plan_.plan.name().empty()) plan_.plan.set_name(plan_.path.stem().string());
  if (auto status = load_plan_landmarks(&plan_); !status.ok()) return status;
  if (auto status = check_bone_file(plan_); !status.ok()) return status;
  take_region_from_zones(&plan_.plan);
  model_spec_ = plan_.plan.model();
  record_.plan = plan_.plan.name();
  record_.up = up_of(model_spec_.scan_region());
  return folder_.prepare();
}

absl::Status Run::reach_daemon() {
  const std::stop_token stop = application_.interrupt().token();
  if (!options_.spawn) {
    connection_ = application_.connect();
    record_.server = connection_->server();
    return absl::OkStatus();
  }
  auto daemon = PrivateDaemon::start(folder_.path() / kPrivateData, stop);
  if (!daemon.ok()) return daemon.status();
  daemon_ = *std::move(daemon);
  connection_ = application_.connect_to(daemon_->server());
  record_.data = kPrivateData;
  return absl::OkStatus();
}

absl::Status Run::prepare_patient() {
  if (!options_.patient.empty()) {
    patient_ = full_name("patients", options_.patient);
    return absl::OkStatus();
  }
  const auto patient =
      connection_->call<PatientService>(&PatientService::Stub::CreatePatient, v1::CreatePatientRequest());
  if (!patient.ok()) return patient.status();
  patient_ = patient->name();
  made_patient_ = true;
  return absl::OkStatus();
}

absl::StatusOr<v1::Scan> Run::send_surface(const std::filesystem::path& file, v1::ScanUnit unit, const char* what) {
  auto scan = upload_scan(*connection_, patient_, file, unit, [this, what](uint64_t sent, uint64_t size) {
    progress_.show(absl::StrFormat("sending the %s: %d of %d bytes", what, sent, size));
  });
  if (!scan.ok()) return scan.status();
  progress_.finish(
      absl::StrFormat("%s: %d vertices, %d triangles", what, scan->report().vertices(), scan->report().triangles()));
  return scan;
}

absl::Status Run::send_scan() {
  if (plan_.scan_file) {
    const auto scan = send_surface(*plan_.scan_file, plan_.plan.scan().unit(), "scan");
    if (!scan.ok()) return scan.status();
    model_spec_.mutable_scan_region()->set_scan(scan->name());
  }
  if (plan_.bone_file) {
    const auto bone = send_surface(*plan_.bone_file, plan_.plan.bone().unit(), "bone");
    if (!bone.ok()) return bone.status();
    model_spec_.mutable_scan_region()->set_bone_scan(bone->name());
  }
  return absl::OkStatus();
}

absl::Status Run::build() {
  v1::BuildModelRequest request;
  request.set_parent(patient_);
  *request.mutable_spec() = model_spec_;
  auto model = build_model(*connection_, request, [this](const std::string& stage, double fraction) {
    progress_.show(absl::StrFormat("building the model: %.0f %%  %s", 100.0 * fraction, stage));
  });
  if (!model.ok()) return model.status();
  model_ = *std::move(model);
  const v1::ModelReport& report = model_.report();
  progress_.finish(absl::StrFormat("model: %d hexahedra over %.1f cm2, worst scaled Jacobian %.2f", report.hexahedra(),
                                   report.area_cm2(), report.min_scaled_jacobian()));
  for (const std::string& remark : report.scan_remarks()) progress_.note(absl::StrCat("  ", remark));
  for (const auto line : absl::StrSplit(layers_text(report), '\n', absl::SkipEmpty()))
    progress_.note(std::string(line));
  return absl::OkStatus();
}

absl::Status Run::create_simulation() {
  v1::CreateSimulationRequest request;
  request.set_display_name(display_name_of(plan_.plan.name()));
  *request.mutable_spec() = plan_.plan.simulation();
  request.mutable_spec()->set_model(model_.name());
  progress_.show("setting up the simulation");
  auto simulation = connection_->call<SimulationService>(&SimulationService::Stub::CreateSimulation, request,
                                                         Connection::kCreationTimeout);
  if (!simulation.ok()) return simulation.status();
  simulation_ = *std::move(simulation);
  record_.simulation = simulation_.name();
  return absl::OkStatus();
}

absl::Status Run::write_results() {
  auto simulation = get_simulation(*connection_, simulation_.name());
  if (!simulation.ok()) return simulation.status();
  simulation_ = *std::move(simulation);
  tell_preview();
  if (auto status = fetch_series(*connection_, simulation_.name(), &rows_); !status.ok()) return status;
  if (!rows_.empty()) progress_.finish(progress_text(rows_.back()));
  record_.kept = options_.keep;
  if (auto status = write_run_record(folder_.path(), record_); !status.ok()) return status;
  return write_figures(folder_.path(), record_.plan, simulation_, rows_);
}

absl::Status Run::evaluate() {
  if (options_.evaluate.empty()) return absl::OkStatus();
  absl::Status picture_problem;
  const auto evaluation = evaluate_into(folder_.path(), *connection_, simulation_, options_.evaluate,
                                        options_.target_unit, &picture_problem);
  if (!evaluation.ok()) return evaluation.status();
  if (!picture_problem.ok()) std::cerr << "lipofill: no distance.png: " << picture_problem.message() << "\n";
  if (!application_.json && !options_.quiet) std::cout << describe(*evaluation) << "\n";
  return absl::OkStatus();
}

/// A run without a picture is still a run: what hinders it is told, not failed for.
void Run::draw() {
  progress_.show("drawing picture.png");
  const absl::Status status = draw_picture(folder_.path(), Picture::kResult, folder_.path() / "picture.png");
  if (!status.ok()) std::cerr << "lipofill: no picture.png: " << status.message() << "\n";
  progress_.finish();
}

/// Deletes everything of the run from the daemon with --discard, and always that which never became
/// a result.
void Run::clean_up() {
  if (options_.keep && !simulation_.name().empty()) return;
  if (connection_) {
    const Connection connection = connection_->without_stop();
    if (!simulation_.name().empty()) {
      v1::DeleteSimulationRequest request;
      request.set_name(simulation_.name());
      (void)connection.call<SimulationService>(&SimulationService::Stub::DeleteSimulation, request);
    }
    if (made_patient_) {
      v1::DeletePatientRequest request;
      request.set_name(patient_);
      request.set_force(true);
      (void)connection.call<PatientService>(&PatientService::Stub::DeletePatient, request);
    }
  }
  if (daemon_) {
    daemon_.reset();
    std::error_code error;
    std::filesystem::remove_all(folder_.path() / kPrivateData, error);
  }
}

void Run::print_summary() const {
  if (application_.json) {
    std::cout << summary_json(record_.plan, simulation_) << std::flush;
  } else if (!options_.quiet) {
    std::cout << summary_text(record_.plan, simulation_) << "results in " << folder_.path().string() << "\n"
              << std::flush;
  }
}

ExitCode Run::exit_code() const {
  const bool reached =
      simulation_.state() == v1::Simulation::SETTLED || simulation_.state() == v1::Simulation::FINISHED;
  return reached ? ExitCode::kOk : ExitCode::kGoalNotReached;
}

}  // namespace lipofill::client
