#pragma once

#include <optional>

#include "client/cli/application.h"
#include "client/cli/progress_line.h"
#include "client/cli/run_ground.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::client {

struct DeliverOptions : GroundOptions {
  std::optional<double> max_pass_ml;
  std::optional<double> tunnel_spacing_mm;
  bool compare = false;
  bool keep = false;
  bool quiet = false;
};

/// An injection list made on a daemon: each member function is one step, in their order in
/// `carry_out`. Checked by tests/integration/cli/deliver_test.cc.
class DeliverRun {
 public:
  DeliverRun(Application& application, DeliverOptions options);

  absl::StatusOr<ExitCode> carry_out();

 private:
  absl::Status read_plan();
  absl::Status prepare_ground();
  absl::Status list_passes();
  absl::Status write_results() const;
  void print() const;

  Application& application_;
  const DeliverOptions options_;
  ProgressLine progress_;
  RunGround ground_;
  v1::Delivery delivery_;
};

}  // namespace lipofill::client
