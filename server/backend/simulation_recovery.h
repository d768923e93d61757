#pragma once

#include "server/backend/backend.h"

namespace lipofill::server {

/// Brings the simulations back that had not ended when the daemon did: each from its newest
/// checkpoint that can be used, or from its start, repeating the commands that were acknowledged
/// after it. Those that ran go on. One that cannot be brought back yet, for want of memory, room or
/// a file, is awaited (Backend::awaited), and says what it waits for; one whose plan or log is lost
/// has failed; the others do not suffer from it. Returns when all were tried; models are built
/// again on as many threads as there are workers. Those that were parked stay so. Checked by
/// tests/unit/server/backend/simulation_recovery_test.cc and
/// tests/integration/service/resume_test.cc.
absl::Status bring_back_simulations(Backend& backend);

/// The same for one that is awaited.
void try_to_bring_back(Backend& backend, const std::string& id);

/// The same for one that was parked; it is held. RESOURCE_EXHAUSTED when there is no room for it
/// now.
absl::StatusOr<std::shared_ptr<Session>> wake_simulation(Backend& backend, const SimulationRecord& record);

}  // namespace lipofill::server
