#include "client/cli/face_run.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/cli/picture.h"
#include "client/cli/result_files.h"
#include "client/cli/simulation_calls.h"
#include "client/cli/whole_face.h"
#include "client/cpp/errors.h"
#include "client/cpp/io/result_folder.h"
#include "client/cpp/json_file.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/result_text.h"
#include "lipofill/v1/planning_service.grpc.pb.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::SimulationService;

constexpr std::chrono::milliseconds kFollowPeriod(200);

/// Joins what holds for all parts, and what a part adds to it.
v1::Plan plan_of_part(const v1::Plan& face, const v1::PlanPart& part) {
  v1::Plan plan = face;
  plan.clear_parts();
  plan.set_name(part.name());
  plan.mutable_model()->MergeFrom(part.model());
  plan.mutable_simulation()->MergeFrom(part.simulation());
  take_region_from_zones(&plan);
  return plan;
}

RunOptions with_parts(RunOptions options) {
  options.several_parts = true;
  return options;
}

bool has_reached_its_goal(v1::Simulation::State state) {
  return state == v1::Simulation::SETTLED || state == v1::Simulation::FINISHED;
}

}  // namespace

bool has_parts(const std::string& plan) {
  const auto loaded = load_plan(plan);
  return loaded.ok() && loaded->plan.parts_size() > 0;
}

FaceRun::FaceRun(Application& application, RunOptions options)
    : application_(application),
      options_(with_parts(std::move(options))),
      progress_(options_.quiet),
      ground_(application, options_, progress_) {}

absl::StatusOr<ExitCode> FaceRun::carry_out() {
  absl::Status status;
  for (const auto step :
       {&FaceRun::read_plan, &FaceRun::prepare_ground, &FaceRun::build_parts, &FaceRun::arrange,
        &FaceRun::create_simulations, &FaceRun::follow, &FaceRun::write_parts, &FaceRun::write_whole_face}) {
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

absl::Status FaceRun::read_plan() {
  std::vector<FieldViolation> violations;
  for (const auto& [is_given, option] :
       {std::pair(!options_.evaluate.empty(), "--evaluate"),
        std::pair(options_.interval_ms.has_value(), "--interval-ms"), std::pair(options_.preview, "--preview")}) {
    if (is_given)
      violations.push_back({option, "is not for a plan of several parts; use it on the simulation of one of them"});
  }
  if (!violations.empty()) return invalid_fields("a plan of several parts", violations);
  if (auto status = ground_.read_plan(); !status.ok()) return status;
  const v1::Plan& plan = ground_.plan().plan;
  if (!ground_.plan().scan_file) {
    return invalid_fields("a plan of several parts", {{"scan", "is missing: parts are of a face"}});
  }
  for (const v1::PlanPart& part : plan.parts()) {
    if (part.name().empty())
      return invalid_fields("a plan of several parts", {{"parts.name", "is missing; each part needs one"}});
  }
  return ground_.make_folder();
}

absl::Status FaceRun::prepare_ground() {
  for (const auto step : {&RunGround::reach_daemon, &RunGround::prepare_patient, &RunGround::send_scan}) {
    if (const absl::Status status = (ground_.*step)(); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status FaceRun::build_parts() {
  for (const v1::PlanPart& part : ground_.plan().plan.parts()) {
    const v1::Plan plan = plan_of_part(ground_.plan().plan, part);
    const auto model = ground_.build_for(plan.model(), part.name());
    if (!model.ok())
      return absl::Status(model.status().code(),
                          absl::StrCat("part '", part.name(), "': ", error_text(model.status())));
    v1::ArrangedPart& arranged = parts_.emplace_back();
    arranged.set_name(part.name());
    arranged.add_of(part.name());
    *arranged.mutable_plan() = plan.simulation();
    arranged.mutable_plan()->set_model(model->name());
  }
  return absl::OkStatus();
}

/// Makes one of parts that touch, directly or through others, on a model of all their zones.
absl::Status FaceRun::arrange() {
  v1::ArrangeFaceRequest request;
  for (const v1::ArrangedPart& part : parts_) {
    v1::FacePart& asked = *request.add_parts();
    asked.set_name(part.name());
    *asked.mutable_plan() = part.plan();
  }
  const auto arrangement =
      ground_.connection().call<v1::PlanningService>(&v1::PlanningService::Stub::ArrangeFace, request);
  if (!arrangement.ok()) return arrangement.status();
  parts_.assign(arrangement->parts().begin(), arrangement->parts().end());
  remarks_.assign(arrangement->remarks().begin(), arrangement->remarks().end());
  for (v1::ArrangedPart& part : parts_) {
    if (!part.has_model_spec()) continue;
    progress_.note(absl::StrFormat("parts %s are simulated together: their zones come within %.1f mm of one another",
                                   absl::StrJoin(part.of(), ", "), part.distance_mm()));
    const auto model = ground_.build_for(part.model_spec(), part.name());
    if (!model.ok()) return model.status();
    part.mutable_plan()->set_model(model->name());
  }
  for (const std::string& remark : remarks_) progress_.note("  " + remark);
  return absl::OkStatus();
}

absl::Status FaceRun::create_simulations() {
  for (const v1::ArrangedPart& part : parts_) {
    progress_.show(absl::StrCat("setting up ", part.name()));
    v1::CreateSimulationRequest request;
    request.set_display_name(display_name_of(part.name()));
    *request.mutable_spec() = part.plan();
    if (options_.fast) aim_at_settled_shape(*request.mutable_spec()->mutable_time());
    request.set_start(true);
    auto simulation = ground_.connection().call<SimulationService>(&SimulationService::Stub::CreateSimulation, request,
                                                                   Connection::kCreationTimeout);
    if (!simulation.ok()) {
      return absl::Status(simulation.status().code(),
                          absl::StrCat("part '", part.name(), "': ", error_text(simulation.status())));
    }
    simulations_.push_back(*std::move(simulation));
  }
  return absl::OkStatus();
}

absl::Status FaceRun::follow() {
  while (true) {
    size_t ended = 0;
    std::vector<std::string> states;
    for (v1::Simulation& simulation : simulations_) {
      if (!has_ended(simulation.state())) {
        auto now = get_simulation(ground_.connection(), simulation.name());
        if (!now.ok()) return now.status();
        simulation = *std::move(now);
      }
      ended += has_ended(simulation.state()) ? 1 : 0;
      states.push_back(absl::StrCat(parts_[states.size()].name(), " ", state_name(simulation.state())));
    }
    progress_.show(absl::StrJoin(states, ", "));
    if (ended == simulations_.size()) return absl::OkStatus();
    if (application_.interrupt().requested()) return absl::CancelledError("interrupted");
    std::this_thread::sleep_for(kFollowPeriod);
  }
}

absl::Status FaceRun::write_parts() {
  progress_.finish();
  for (size_t k = 0; k < parts_.size(); ++k) {
    const auto written = export_result(ground_.connection(), simulations_[k].name(),
                                       std::filesystem::path(options_.out) / parts_[k].name());
    if (!written.ok()) return written.status();
  }
  return absl::OkStatus();
}

absl::Status FaceRun::write_whole_face() {
  WholeFace face;
  for (const v1::Simulation& simulation : simulations_) {
    auto state = final_state(ground_.connection(), simulation, {"scan"});
    if (!state.ok()) return state.status();
    if (auto status = face.add(*std::move(state)); !status.ok()) return status;
  }
  ResultFolder folder(options_.out);
  if (auto status = folder.prepare(); !status.ok()) return status;
  RunRecord record;
  record.plan = ground_.plan().plan.name();
  record.simulation = simulations_.front().name();
  record.up = up_of(ground_.plan().plan.model().scan_region());
  record.kept = options_.keep;
  if (ground_.is_private()) {
    record.data = RunGround::kPrivateData;
  } else {
    record.server = ground_.connection().server();
  }
  if (auto status = write_run_record(options_.out, record); !status.ok()) return status;
  folder.set_meshes(face.meshes());
  if (auto status = folder.write_frame(face.time_s(), face.fields()); !status.ok()) return status;
  return write_text_file(folder.path() / "summary.json", summary());
}

void FaceRun::draw() {
  progress_.show("drawing picture.png");
  const std::filesystem::path folder(options_.out);
  absl::Status status = draw_picture(folder, Picture::kResult, folder / "picture.png");
  for (const v1::ArrangedPart& part : parts_) {
    status.Update(draw_picture(folder / part.name(), Picture::kResult, folder / part.name() / "picture.png"));
  }
  if (!status.ok()) std::cerr << "lipofill: no picture.png: " << status.message() << "\n";
  progress_.finish();
}

/// Deletes everything of the run from the daemon with --discard, and always that which never became
/// a result.
void FaceRun::clean_up() {
  const bool is_result = !parts_.empty() && simulations_.size() == parts_.size();
  if (options_.keep && is_result) return;
  for (const v1::Simulation& simulation : simulations_) {
    v1::DeleteSimulationRequest request;
    request.set_name(simulation.name());
    (void)ground_.connection().without_stop().call<SimulationService>(&SimulationService::Stub::DeleteSimulation,
                                                                      request);
  }
  ground_.delete_patient();
  ground_.end_daemon();
}

std::string FaceRun::summary() const {
  nlohmann::ordered_json parts = nlohmann::ordered_json::array();
  for (size_t k = 0; k < parts_.size(); ++k) {
    auto part = nlohmann::ordered_json::parse(summary_json(parts_[k].name(), simulations_[k]));
    part["of"] = std::vector<std::string>(parts_[k].of().begin(), parts_[k].of().end());
    parts.push_back(std::move(part));
  }
  return summary_of_face(ground_.plan().plan.name(), parts, remarks_).dump(2) + "\n";
}

void FaceRun::print_summary() const {
  if (application_.json) {
    std::cout << summary() << std::flush;
    return;
  }
  if (options_.quiet) return;
  for (size_t k = 0; k < parts_.size(); ++k) std::cout << summary_text(parts_[k].name(), simulations_[k]) << "\n";
  std::cout << "results in " << options_.out << ", a folder a part; the whole face in scan_0000.vtp\n" << std::flush;
}

ExitCode FaceRun::exit_code() const {
  const bool reached = std::all_of(simulations_.begin(), simulations_.end(), [](const v1::Simulation& simulation) {
    return has_reached_its_goal(simulation.state());
  });
  return reached ? ExitCode::kOk : ExitCode::kGoalNotReached;
}

}  // namespace lipofill::client
