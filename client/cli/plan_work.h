#pragma once

#include <string>

#include "client/cli/application.h"
#include "client/cli/progress_line.h"
#include "client/cli/run_ground.h"

namespace lipofill::client {

struct PlanWorkOptions : GroundOptions {
  bool keep = false;
  bool quiet = false;
};

/// The options of work on a plan: the plan, --out, --spawn to --unit, --keep and --quiet.
void add_plan_work_options(CLI::App& command, PlanWorkOptions& options);

/// Work that a daemon does on the model of a plan, from the plan's file to results in a folder:
/// what a proposal, an injection list and a forecast have in common. Unless they are to be kept,
/// patient and scans are deleted from the daemon when it is done. Checked by
/// tests/integration/cli/propose_test.cc, deliver_test.cc and forecast_test.cc.
class PlanWork {
 public:
  virtual ~PlanWork() = default;

  absl::StatusOr<ExitCode> carry_out();

 protected:
  PlanWork(Application& application, const PlanWorkOptions& options);

  /// Checks what can be checked before a model is built.
  virtual absl::Status check_input() { return absl::OkStatus(); }
  /// Does the work, on the model that was built.
  virtual absl::Status work() = 0;
  virtual absl::Status write_results() const = 0;
  /// These give what is printed, for programs and for people.
  virtual std::string json() const = 0;
  virtual std::string text() const = 0;
  /// The option behind a field of the request, or what the field is called in the plan's file.
  virtual std::string option_of(const std::string& field) const = 0;

  ProgressLine progress_;
  RunGround ground_;

 private:
  absl::Status prepare_and_work();

  Application& application_;
  const PlanWorkOptions options_;
};

}  // namespace lipofill::client
