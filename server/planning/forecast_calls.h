#pragma once

#include "absl/status/statusor.h"
#include "lipofill/v1/forecast_service.pb.h"
#include "server/backend/backend.h"
#include "server/security/principal.h"

namespace lipofill::server {

/// Starts the operation that makes a forecast, or finds the one an equal request started. What can
/// be refused at once is. Nothing of a forecast is kept but its operation: the same request has the
/// same forecast, so that after a restart it is asked for again.
absl::StatusOr<OperationView> start_forecast(Backend& backend, const Principal& caller,
                                             const v1::MakeForecastRequest& request);

}  // namespace lipofill::server
