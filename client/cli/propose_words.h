#pragma once

#include <string>

#include "absl/status/status.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::client {

/// What is proposed, what it reaches and what is left, as people read it.
std::string describe(const v1::Proposal& proposal);

/// The same error with the options of `lipofill propose` in place of the fields of its request, and
/// fields of the plan's file as they are called there. Checked by
/// tests/integration/cli/propose_test.cc.
absl::Status name_options(const absl::Status& status);

}  // namespace lipofill::client
