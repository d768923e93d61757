#pragma once

#include <grpcpp/support/status.h>

#include "absl/status/status.h"

namespace lipofill::server {

/// The one place where a status of ours becomes one of the wire: code and message, and in the
/// details a google.rpc.Status with an ErrorInfo {reason, domain "lipofill"},
/// where it makes sense to try again a RetryInfo, and, where there are field violations, a
/// BadRequest.
/// Checked by tests/unit/server/wire/status_mapping_test.cc.
grpc::Status to_grpc_status(const absl::Status& status);

}  // namespace lipofill::server
