#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/connection.h"
#include "client/cpp/frame_watcher.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

absl::StatusOr<v1::Simulation> get_simulation(const Connection& connection, const std::string& name);

/// True when a simulation has ended, in whatever way.
bool has_ended(v1::Simulation::State state);

/// Adds the rows after the last one held, all that there are.
absl::Status fetch_series(const Connection& connection, const std::string& simulation,
                          std::vector<v1::SeriesRow>* rows);

/// The names of all meshes a simulation has: "skin", its films, "scan" where its model was cut from
/// one, "tissue" where it has layers. A simulation outlives its model: without that, only those its
/// own plan tells of.
absl::StatusOr<std::vector<std::string>> mesh_names(const Connection& connection, const v1::Simulation& simulation);

struct FinalState {
  Meshes meshes;
  Frame frame;
};

/// The last frame of a simulation that has ended. FAILED_PRECONDITION for one that has not.
absl::StatusOr<FinalState> final_state(const Connection& connection, const v1::Simulation& simulation,
                                       const std::vector<std::string>& meshes);

}  // namespace lipofill::client
