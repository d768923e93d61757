#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/forecast/forecast.h"
#include "lipofill/v1/forecast_service.pb.h"

namespace lipofill::server {

/// A forecast's specification in SI. Field violations named as in lipofill.v1.ForecastSpec.
/// Checked by tests/integration/service/forecast_test.cc.
absl::StatusOr<forecast::ForecastRequest> to_forecast_request(const v1::ForecastSpec& spec);
v1::Forecast to_forecast(const forecast::Forecast& forecast);
/// The inputs alone.
v1::Forecast to_forecast_inputs(const std::vector<forecast::UncertainInput>& inputs);

/// The answer to EstimateRetention. Field violations named as in its request.
absl::StatusOr<v1::RetentionEstimate> estimate_retention(const v1::EstimateRetentionRequest& request);

}  // namespace lipofill::server
