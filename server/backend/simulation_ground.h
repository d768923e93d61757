#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lipofill/v1/simulation.pb.h"
#include "server/backend/backend.h"
#include "server/sessions/replay.h"

namespace lipofill::server {

/// The state a simulation goes on from.
struct Ground {
  std::unique_ptr<simulation::Simulation> simulation;
  v1::SimulationSpec spec;
  CheckpointRecord checkpoint;  ///< is the start where it has step 0 and no command
  std::string note;             ///< which checkpoints could not be used
};

/// Finds the newest state that a simulation can go on from: that of a checkpoint on its course, or
/// the start. Checkpoints that cannot be used are passed over, and told. UNAVAILABLE where
/// something is missing that may be there another time, DATA_LOSS where the plan or the log is
/// lost.
/// @param commands  the log of the simulation
absl::StatusOr<Ground> find_ground(Backend& backend, const SimulationRecord& record,
                                   const std::vector<CommandRecord>& commands);

/// Collects the commands that were acknowledged after the state that it goes on from.
absl::StatusOr<SessionHistory> history_from(const Ground& ground, const SimulationRecord& record,
                                            const std::vector<CommandRecord>& commands);

/// For what may be there another time: a model that cannot be built for want of memory or of a
/// file, a file that is put back. What the store itself holds does not come back.
absl::Status waits_for(const absl::Status& why);

}  // namespace lipofill::server
