#pragma once

#include "absl/status/statusor.h"
#include "core/planning/proposal.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::server {

/// Reads what to propose, in SI. INVALID_ARGUMENT with field violations below "plan", "bounds",
/// "zones", "spread" and of the other fields of the message. Checked by
/// tests/integration/service/proposal_test.cc.
absl::StatusOr<planning::ProposalRequest> to_proposal_request(const v1::ProposalSpec& spec);

/// A proposal, without how long it took. Its plan is that of the request with what was proposed:
/// what the request says and the proposal does not touch stays as it was written.
v1::Proposal to_proposal(const v1::ProposalSpec& spec, const planning::Proposal& proposal);

}  // namespace lipofill::server
