#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

/// A bound on a figure of an evaluation, "p95_mm<=2".
struct Requirement {
  std::string text;
  std::vector<std::string> path;  ///< names of fields, from the evaluation down to the figure
  bool at_most = true;
  double bound = 0.0;

  double figure_of(const v1::Evaluation& evaluation) const;
  /// False for a figure that is not a number.
  bool is_met(double figure) const { return at_most ? figure <= bound : figure >= bound; }
};

/// Takes the texts apart. INVALID_ARGUMENT for one that is none, or whose figure there is not; it
/// names those there are. Checked by tests/unit/client/requirement_test.cc.
absl::StatusOr<std::vector<Requirement>> read_requirements(const std::vector<std::string>& texts);

}  // namespace lipofill::client
