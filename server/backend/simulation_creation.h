#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/backend.h"
#include "server/security/principal.h"

namespace lipofill::server {

/// A simulation as the wire shows it: the record, and the session's figures where it is still in
/// memory.
v1::Simulation to_simulation(const SimulationRecord& record, const SessionView* view);

/// The same for one that is not in memory: it may have ended, be parked, or not be back yet.
v1::Simulation show_without_session(const Backend& backend, const SimulationRecord& record);

/// The simulation as it is now.
absl::StatusOr<v1::Simulation> show_simulation(Backend& backend, const std::string& id);

/// The core's simulation of a plan; the model may have to be built again. Field violations below
/// "spec".
absl::StatusOr<std::unique_ptr<simulation::Simulation>> make_simulation(Backend& backend, const std::string& model,
                                                                        plan::SimulationSpec plan);
/// The same for a plan that was kept.
absl::StatusOr<std::unique_ptr<simulation::Simulation>> make_simulation(Backend& backend, const std::string& model,
                                                                        const v1::SimulationSpec& spec);
SessionOptions make_session_options(const Backend& backend, const SimulationRecord& record, uint64_t epoch,
                                    const v1::SimulationSpec& spec);

/// Lets others find a session whose record was just made, and starts it where asked. Without room
/// for it, or when its model went meanwhile, the record goes too.
absl::StatusOr<v1::Simulation> open_session(Backend& backend, SessionManager::Place place,
                                            const SimulationRecord& record, std::shared_ptr<Session> session,
                                            bool start);
/// Returns the simulation that an equal request made before; starts it now if that request did not.
absl::StatusOr<v1::Simulation> show_made_before(Backend& backend, const std::string& name, bool start);

/// Deletes the record of a simulation and all that belongs to it. ABORTED when an etag is given
/// that is not its.
absl::Status delete_simulation_record(Backend& backend, const std::string& id, const std::string& etag = "");

/// Makes the simulation (the core checks the specification), its record and its session, or finds
/// what an equal request made. May take seconds: the model may have to be built again. CANCELLED
/// when it is unwanted by then.
absl::StatusOr<v1::Simulation> create_simulation(Backend& backend, const Principal& caller,
                                                 const v1::CreateSimulationRequest& request, const Unwanted& unwanted);

}  // namespace lipofill::server
