#include "client/cli/propose_run.h"

#include <filesystem>
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
    : PlanWork(application, options), options_(std::move(options)) {}

/// A target that is missing is told of before a model is built for it.
absl::Status ProposeRun::check_input() {
  std::error_code error;
  if (is_on_daemon(options_.target) || std::filesystem::is_regular_file(options_.target, error)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat("--target: ", options_.target, " does not exist or is not a file"));
}

absl::Status ProposeRun::work() {
  const absl::Status sent = send_target();
  return sent.ok() ? propose() : sent;
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

std::string ProposeRun::json() const {
  return message_json(proposal_);
}

std::string ProposeRun::text() const {
  return absl::StrCat(describe(proposal_), "plan.json and proposal.json in ", options_.out, "\n");
}

std::string ProposeRun::option_of(const std::string& field) const {
  return proposal_option_of(field);
}

}  // namespace lipofill::client
