#pragma once

#include "absl/status/status.h"
#include "google/rpc/status.pb.h"

namespace lipofill::server {

/// A status with its details, as operations carry it and as it travels with a failed call.
google::rpc::Status to_error_message(const absl::Status& status);

}  // namespace lipofill::server
