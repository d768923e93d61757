#include "client/cli/run.h"

#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "client/cli/describe.h"
#include "client/cli/picture.h"
#include "client/cli/result_files.h"
#include "client/cli/simulation_calls.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/result_text.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::SimulationService;

}  // namespace

void aim_at_settled_shape(v1::TimeControl& time) {
  time.set_goal(v1::TimeControl::SETTLED_SHAPE);
  time.clear_max_step_ms();
  time.clear_max_injection_step_ms();
  time.clear_error_tolerance_mm();
}

Run::Run(Application& application, RunOptions options)
    : application_(application),
      options_(std::move(options)),
      progress_(options_.quiet),
      ground_(application, options_, progress_),
      folder_(options_.out) {}

absl::StatusOr<ExitCode> Run::carry_out() {
  absl::Status status;
  for (const auto step : {&Run::read_plan, &Run::prepare_ground, &Run::create_simulation, &Run::simulate,
                          &Run::write_results, &Run::evaluate}) {
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
  if (auto status = ground_.read_plan(); !status.ok()) return status;
  v1::Plan& plan = ground_.plan().plan;
  if (options_.interval_ms) plan.mutable_output()->set_interval_ms(*options_.interval_ms);
  if (options_.preview) plan.mutable_simulation()->set_preview(true);
  if (options_.fast) aim_at_settled_shape(*plan.mutable_simulation()->mutable_time());
  record_.plan = plan.name();
  record_.up = up_of(plan.model().scan_region());
  return folder_.prepare();
}

absl::Status Run::prepare_ground() {
  if (const absl::Status status = ground_.prepare(); !status.ok()) return status;
  if (ground_.is_private()) {
    record_.data = RunGround::kPrivateData;
  } else {
    record_.server = ground_.connection().server();
  }
  return absl::OkStatus();
}

absl::Status Run::create_simulation() {
  v1::CreateSimulationRequest request;
  request.set_display_name(display_name_of(ground_.plan().plan.name()));
  *request.mutable_spec() = ground_.plan().plan.simulation();
  request.mutable_spec()->set_model(ground_.model().name());
  progress_.show("setting up the simulation");
  auto simulation = ground_.connection().call<SimulationService>(&SimulationService::Stub::CreateSimulation, request,
                                                                 Connection::kCreationTimeout);
  if (!simulation.ok()) return simulation.status();
  simulation_ = *std::move(simulation);
  record_.simulation = simulation_.name();
  return absl::OkStatus();
}

absl::Status Run::write_results() {
  auto simulation = get_simulation(ground_.connection(), simulation_.name());
  if (!simulation.ok()) return simulation.status();
  simulation_ = *std::move(simulation);
  tell_preview();
  if (auto status = fetch_series(ground_.connection(), simulation_.name(), &rows_); !status.ok()) return status;
  if (!rows_.empty()) progress_.finish(progress_text(rows_.back()));
  record_.kept = options_.keep;
  if (auto status = write_run_record(folder_.path(), record_); !status.ok()) return status;
  return write_figures(folder_.path(), record_.plan, simulation_, rows_);
}

absl::Status Run::evaluate() {
  if (options_.evaluate.empty()) return absl::OkStatus();
  absl::Status picture_problem;
  const auto evaluation = evaluate_into(folder_.path(), ground_.connection(), simulation_, options_.evaluate,
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
  if (ground_.is_connected() && !simulation_.name().empty()) {
    v1::DeleteSimulationRequest request;
    request.set_name(simulation_.name());
    (void)ground_.connection().without_stop().call<SimulationService>(&SimulationService::Stub::DeleteSimulation,
                                                                      request);
  }
  ground_.delete_patient();
  ground_.end_daemon();
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
