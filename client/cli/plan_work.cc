#include "client/cli/plan_work.h"

#include <iostream>
#include <vector>

#include "client/cpp/errors.h"

namespace lipofill::client {

void add_plan_work_options(CLI::App& command, PlanWorkOptions& options) {
  command.add_option("plan", options.plan, "PLAN.json")->required();
  command.add_option("--out", options.out, "folder of results; made when missing")->required();
  add_ground_options(command, options, "start a private lipofilld for this and stop it after");
  command.add_flag("--keep", options.keep, "keep patient, scans and model on the daemon");
  command.add_flag("--quiet", options.quiet, "no progress, no summary");
}

PlanWork::PlanWork(Application& application, const PlanWorkOptions& options)
    : progress_(options.quiet),
      ground_(application, options, progress_),
      application_(application),
      options_(options) {}

absl::Status PlanWork::prepare_and_work() {
  if (auto status = ground_.make_folder(); !status.ok()) return status;
  if (auto status = check_input(); !status.ok()) return status;
  if (auto status = ground_.read_plan(); !status.ok()) return status;
  if (auto status = ground_.prepare(); !status.ok()) return status;
  return work();
}

absl::StatusOr<ExitCode> PlanWork::carry_out() {
  absl::Status status = prepare_and_work();
  progress_.finish();
  if (status.ok()) status = write_results();
  if (!status.ok() || !options_.keep) {
    ground_.delete_patient();
    ground_.end_daemon();
  }
  if (!status.ok()) {
    std::vector<FieldViolation> violations = error_details_of(status).violations;
    if (violations.empty()) return status;
    for (FieldViolation& violation : violations) violation.field = option_of(violation.field);
    return invalid_fields(std::string(status.message()), violations);
  }
  if (application_.json) {
    std::cout << json() << "\n" << std::flush;
  } else if (!options_.quiet) {
    std::cout << text() << std::flush;
  }
  return ExitCode::kOk;
}

}  // namespace lipofill::client
