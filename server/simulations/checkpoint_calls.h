#pragma once

#include "absl/status/statusor.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/backend.h"
#include "server/security/principal.h"

namespace lipofill::server {

v1::Checkpoint to_checkpoint(const CheckpointRecord& record);

/// Keeps the state of a live simulation, or finds the checkpoint that an equal request made.
absl::StatusOr<v1::Checkpoint> create_checkpoint(Backend& backend, const Principal& caller,
                                                 const v1::CreateCheckpointRequest& request);

/// Takes a live simulation back, or begins a new one, as the request says. May take seconds: the
/// model may have to be built again. DATA_LOSS for a checkpoint whose file is damaged.
absl::StatusOr<v1::Simulation> restore_simulation(Backend& backend, const Principal& caller,
                                                  const v1::RestoreSimulationRequest& request);

absl::Status get_checkpoint(Backend& backend, const v1::GetCheckpointRequest& request, v1::Checkpoint& response);
/// A page of those of a simulation.
absl::Status list_checkpoints(Backend& backend, const v1::ListCheckpointsRequest& request,
                              v1::ListCheckpointsResponse& response);
absl::Status delete_checkpoint(Backend& backend, const v1::DeleteCheckpointRequest& request);

}  // namespace lipofill::server
