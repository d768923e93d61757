#pragma once

#include "absl/status/statusor.h"
#include "core/forecast/grid_error.h"
#include "lipofill/v1/forecast_service.pb.h"

namespace lipofill::server {

/// The error of the grid as a message; only its reason where there is none.
v1::GridError to_grid_error(const absl::StatusOr<forecast::GridError>& error);

}  // namespace lipofill::server
