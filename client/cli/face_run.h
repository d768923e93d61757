#pragma once

#include <string>
#include <vector>

#include "client/cli/application.h"
#include "client/cli/progress_line.h"
#include "client/cli/run.h"
#include "client/cli/run_ground.h"
#include "lipofill/v1/planning_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

/// Tells whether the plan in a file has several parts. False for a file that cannot be read.
bool has_parts(const std::string& plan);

/// A plan of several parts of a face, carried out from scan to results: parts that touch are
/// simulated together, the others side by side. Each member function is one step, in their order in
/// `carry_out`. Checked by tests/integration/cli/face_run_test.cc.
class FaceRun {
 public:
  FaceRun(Application& application, RunOptions options);

  absl::StatusOr<ExitCode> carry_out();

 private:
  absl::Status read_plan();
  absl::Status prepare_ground();
  absl::Status build_parts();
  absl::Status arrange();
  absl::Status create_simulations();
  absl::Status follow();
  absl::Status write_parts();
  absl::Status write_whole_face();
  void draw();
  void clean_up();
  void print_summary() const;
  std::string summary() const;
  ExitCode exit_code() const;

  Application& application_;
  const RunOptions options_;
  ProgressLine progress_;
  RunGround ground_;
  std::vector<v1::ArrangedPart> parts_;
  std::vector<std::string> remarks_;         ///< on how the parts lie to one another
  std::vector<v1::Simulation> simulations_;  ///< one a part
};

}  // namespace lipofill::client
