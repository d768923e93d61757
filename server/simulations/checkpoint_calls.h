#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/backend.h"
#include "server/security/principal.h"

namespace lipofill::server {

v1::Checkpoint to_checkpoint(const CheckpointRecord& record);

/// The error of a command that finds no session: FAILED_PRECONDITION for a simulation that has
/// ended, UNAVAILABLE for one that could not be brought back, or that is still being made (reason
/// BEING_MADE, to be tried again).
absl::Status no_session_for(const char* what, const SimulationRecord& record);

/// Keeps the state of a live simulation, or finds the checkpoint that an equal request made.
absl::StatusOr<v1::Checkpoint> create_checkpoint(Backend& backend, const Principal& caller,
                                                 const v1::CreateCheckpointRequest& request);

/// Takes a live simulation back, or begins a new one, as the request says. May take seconds: the model may have to be
/// built again. DATA_LOSS for a checkpoint whose file is damaged.
absl::StatusOr<v1::Simulation> restore_simulation(Backend& backend, const Principal& caller,
                                                  const v1::RestoreSimulationRequest& request);

/// A checkpoint as it is read back: its plan, and a simulation in its state.
struct LoadedCheckpoint {
  CheckpointContent content;
  v1::SimulationSpec spec;
  std::unique_ptr<simulation::Simulation> simulation;
};
absl::StatusOr<LoadedCheckpoint> load_checkpoint(Backend& backend, const CheckpointRecord& record,
                                                 const std::string& model);

}  // namespace lipofill::server
