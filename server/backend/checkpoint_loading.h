#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "lipofill/v1/simulation.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// A checkpoint as it is read back: its plan, and a simulation in its state.
struct LoadedCheckpoint {
  CheckpointContent content;
  v1::SimulationSpec spec;
  std::unique_ptr<simulation::Simulation> simulation;
};
absl::StatusOr<LoadedCheckpoint> load_checkpoint(Backend& backend, const CheckpointRecord& record,
                                                 const std::string& model);

}  // namespace lipofill::server
