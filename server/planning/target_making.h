#pragma once

#include "absl/status/statusor.h"
#include "lipofill/v1/planning_service.pb.h"
#include "server/backend/backend.h"
#include "server/security/principal.h"

namespace lipofill::server {

/// Starts the operation that makes a target and keeps it as a scan, or finds the one an equal
/// request started. What can be refused at once is.
absl::StatusOr<OperationView> start_target(Backend& backend, const Principal& caller,
                                           const v1::MakeTargetRequest& request);

}  // namespace lipofill::server
