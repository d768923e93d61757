#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "lipofill/v1/frame_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Rows of the time series after a step, from the store and, for what is not there yet, from the
/// session. At most 10000, and no more than fit a message.
absl::Status read_series(Backend& backend, const std::string& id, uint64_t after_step, v1::GetSeriesResponse& response);

/// Meshes at rest and fields of a simulation as it is now or, from the store, as it was when it
/// ended.
struct PresentResult {
  v1::MeshSlice meshes;
  v1::FrameSlice frame;
};

/// Takes at least the named meshes: what the store keeps comes whole. Waits for the step at hand.
absl::StatusOr<PresentResult> read_present(Backend& backend, const std::string& id,
                                           const std::vector<std::string>& meshes);

/// Distance of the simulated skin, as it is now or when it ended, to a target scan. CANCELLED once
/// it is unwanted.
absl::StatusOr<v1::Evaluation> evaluate_simulation(Backend& backend, const v1::EvaluateSimulationRequest& request,
                                                   const Unwanted& unwanted);

}  // namespace lipofill::server
