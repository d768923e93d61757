#pragma once

#include <string>
#include <vector>

#include "client/cli/application.h"
#include "client/cli/progress_line.h"
#include "client/cli/run_ground.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::client {

struct ProposeOptions : GroundOptions {
  std::string target;  ///< a surface file, or patients/ID/scans/ID
  v1::ScanUnit target_unit = v1::MILLIMETRE;
  bool keep = false;
  bool quiet = false;
  v1::ProposalSpec spec;  ///< bounds and the rest, without plan and target
};

/// A plan proposed on a daemon, from scan and target to a plan file that runs: each member function
/// is one step, in their order in `carry_out`.
class ProposeRun {
 public:
  ProposeRun(Application& application, ProposeOptions options);

  absl::StatusOr<ExitCode> carry_out();

 private:
  absl::Status read_plan();
  absl::Status prepare_ground();
  absl::Status send_target();
  absl::Status propose();
  absl::Status write_results() const;
  void print() const;

  Application& application_;
  const ProposeOptions options_;
  ProgressLine progress_;
  RunGround ground_;
  std::string target_;
  v1::Proposal proposal_;
};

}  // namespace lipofill::client
