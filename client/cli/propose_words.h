#pragma once

#include <string>

#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::client {

/// Says what is proposed, what it reaches and what is left, as people read it.
std::string describe(const v1::Proposal& proposal);

/// The option of `lipofill propose` behind a field of its request; a field of the plan as it is
/// called in its file. Checked by tests/integration/cli/propose_test.cc.
std::string proposal_option_of(const std::string& field);

}  // namespace lipofill::client
