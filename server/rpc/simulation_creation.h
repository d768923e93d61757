#pragma once

#include <functional>

#include "absl/status/statusor.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/rpc/backend.h"

namespace lipofill::server {

/// A simulation as the wire shows it: the record, and the session's figures where it is still in memory.
v1::Simulation to_simulation(const SimulationRecord& record, const SessionView* view);

/// Makes the simulation (the core checks the specification), its record and its session, or finds what an equal request
/// made. May take seconds: the model may have to be built again.
absl::StatusOr<v1::Simulation> create_simulation(Backend& backend, const v1::CreateSimulationRequest& request,
                                                 const std::function<bool()>& caller_has_left);

}  // namespace lipofill::server
