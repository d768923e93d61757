#pragma once

#include "absl/status/statusor.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/rpc/backend.h"

namespace lipofill::server {

/// Rows of the time series after a step, from the store and, for what is not there yet, from the session. At most
/// 10000, and no more than fit a message.
absl::Status read_series(Backend& backend, const std::string& id, uint64_t after_step, v1::GetSeriesResponse& response);

/// Distance of the simulated skin, as it is now or when it ended, to a target scan.
absl::StatusOr<v1::Evaluation> evaluate_simulation(Backend& backend, const v1::EvaluateSimulationRequest& request);

}  // namespace lipofill::server
