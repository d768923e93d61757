#pragma once

#include "absl/status/statusor.h"
#include "lipofill/v1/planning_service.pb.h"
#include "server/backend/backend.h"
#include "server/security/principal.h"

namespace lipofill::server {

/// Starts the operation that proposes a plan, or finds the one an equal request started. What can
/// be refused at once is. Nothing of a proposal is kept but its operation: the same request has the
/// same proposal, so that after a restart it is asked for again.
absl::StatusOr<OperationView> start_proposal(Backend& backend, const Principal& caller,
                                             const v1::ProposePlanRequest& request);

}  // namespace lipofill::server
