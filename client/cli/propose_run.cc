#include "client/cli/propose_run.h"

#include <filesystem>
#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/changed_plan.h"
#include "client/cli/propose_words.h"
#include "client/cpp/json_file.h"
#include "client/cpp/json_message.h"
#include "client/cpp/model_build.h"
#include "lipofill/v1/planning_service.grpc.pb.h"

namespace lipofill::client {
namespace {

bool is_on_daemon(const std::string& surface) {
  return surface.starts_with("patients/");
}

}  // namespace

ProposeRun::ProposeRun(Application& application, ProposeOptions options)
    : application_(application),
      options_(std::move(options)),
      progress_(options_.quiet),
      ground_(application, options_, progress_) {}

absl::StatusOr<ExitCode> ProposeRun::carry_out() {
  absl::Status status;
  for (const auto step :
       {&ProposeRun::read_plan, &ProposeRun::prepare_ground, &ProposeRun::send_target, &ProposeRun::propose}) {
    status = (this->*step)();
    if (!status.ok()) break;
  }
  progress_.finish();
  if (status.ok()) status = write_results();
  if (!status.ok() || !options_.keep) {
    ground_.delete_patient();
    ground_.end_daemon();
  }
  if (!status.ok()) return name_options(status);
  print();
  return ExitCode::kOk;
}

absl::Status ProposeRun::read_plan() {
  std::error_code error;
  std::filesystem::create_directories(options_.out, error);
  if (error)
    return absl::InvalidArgumentError(absl::StrCat("cannot make the folder ", options_.out, ": ", error.message()));
  // Said before a model is built for it.
  if (!is_on_daemon(options_.target) && !std::filesystem::is_regular_file(options_.target, error)) {
    return absl::InvalidArgumentError(absl::StrCat("--target: ", options_.target, " does not exist or is not a file"));
  }
  return ground_.read_plan();
}

absl::Status ProposeRun::prepare_ground() {
  for (const auto step :
       {&RunGround::reach_daemon, &RunGround::prepare_patient, &RunGround::send_scan, &RunGround::build}) {
    if (const absl::Status status = (ground_.*step)(); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status ProposeRun::send_target() {
  target_ = options_.target;
  if (is_on_daemon(target_)) return absl::OkStatus();
  const auto scan = ground_.send_surface(options_.target, options_.target_unit, "target");
  if (scan.ok()) target_ = scan->name();
  return scan.status();
}

absl::Status ProposeRun::propose() {
  v1::ProposePlanRequest request;
  request.set_parent(ground_.patient());
  *request.mutable_spec() = options_.spec;
  *request.mutable_spec()->mutable_plan() = ground_.plan().plan.simulation();
  request.mutable_spec()->mutable_plan()->set_model(ground_.model().name());
  request.mutable_spec()->set_target_scan(target_);
  auto operation = ground_.connection().call<v1::PlanningService>(&v1::PlanningService::Stub::ProposePlan, request);
  if (!operation.ok()) return operation.status();
  return finish_operation(
      ground_.connection(), *operation,
      [this](const std::string& stage, double fraction) {
        progress_.show(absl::StrFormat("proposing: %.0f %%  %s", 100.0 * fraction, stage));
      },
      &proposal_);
}

absl::Status ProposeRun::write_results() const {
  const std::filesystem::path folder = options_.out;
  const v1::Plan plan = plan_file_of(ground_.plan(), ground_.model(), proposal_.plan(), folder);
  if (auto status = write_text_file(folder / "plan.json", compact_message_json(plan)); !status.ok()) return status;
  return write_text_file(folder / "proposal.json", message_json(proposal_));
}

void ProposeRun::print() const {
  if (application_.json) {
    std::cout << message_json(proposal_) << "\n" << std::flush;
  } else if (!options_.quiet) {
    std::cout << describe(proposal_) << "plan.json and proposal.json in " << options_.out << "\n" << std::flush;
  }
}

}  // namespace lipofill::client
