#include "client/cli/simulation_calls.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/listing.h"
#include "client/cli/scanned_colours.h"
#include "client/cpp/result_text.h"
#include "lipofill/v1/patient_service.grpc.pb.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {

absl::StatusOr<v1::Simulation> get_simulation(const Connection& connection, const std::string& name) {
  v1::GetSimulationRequest request;
  request.set_name(full_name("simulations", name));
  return connection.call<v1::SimulationService>(&v1::SimulationService::Stub::GetSimulation, request);
}

bool has_ended(v1::Simulation::State state) {
  return state == v1::Simulation::SETTLED || state == v1::Simulation::FINISHED || state == v1::Simulation::STOPPED ||
         state == v1::Simulation::FAILED;
}

absl::Status fetch_series(const Connection& connection, const std::string& simulation,
                          std::vector<v1::SeriesRow>* rows) {
  v1::GetSeriesRequest request;
  request.set_name(simulation);
  for (bool more = true; more;) {
    request.set_after_step(rows->empty() ? 0 : rows->back().step());
    const auto response = connection.call<v1::SimulationService>(&v1::SimulationService::Stub::GetSeries, request);
    if (!response.ok()) return response.status();
    rows->insert(rows->end(), response->rows().begin(), response->rows().end());
    more = response->more() && response->rows_size() > 0;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::string>> mesh_names(const Connection& connection, const v1::Simulation& simulation) {
  std::vector<std::string> names = {"skin"};
  for (const v1::Film& film : simulation.spec().films()) names.push_back(absl::StrCat("film/", film.name()));
  v1::GetModelRequest request;
  request.set_name(simulation.spec().model());
  const auto model = connection.call<v1::PatientService>(&v1::PatientService::Stub::GetModel, request);
  if (absl::IsNotFound(model.status())) return names;
  if (!model.ok()) return model.status();
  if (model->spec().has_scan_region()) names.push_back("scan");
  if (model->spec().layers_size() > 0) names.push_back("tissue");
  return names;
}

absl::StatusOr<FinalState> final_state(const Connection& connection, const v1::Simulation& simulation,
                                       const std::vector<std::string>& meshes) {
  if (!has_ended(simulation.state())) {
    return absl::FailedPreconditionError(absl::StrCat(simulation.name(), " is ", state_name(simulation.state()),
                                                      "; its final state is there once it has ended"));
  }
  v1::WatchRequest request;
  request.set_simulation(simulation.name());
  request.set_delivery(v1::WatchRequest::LATEST);
  request.mutable_meshes()->Assign(meshes.begin(), meshes.end());
  FinalState state;
  WatchHandlers handlers;
  handlers.on_meshes = [&state](Meshes received) {
    state.meshes = std::move(received);
    return absl::OkStatus();
  };
  handlers.on_frame = [&state](Frame frame) {
    state.frame = std::move(frame);
    return absl::OkStatus();
  };
  if (auto status = watch(connection, request, handlers); !status.ok()) return status;
  if (state.meshes.arrays.empty() || state.frame.fields.empty()) {
    return absl::NotFoundError(absl::StrCat("the daemon keeps no final frame of ", simulation.name()));
  }
  add_scanned_colours(connection, simulation, &state.meshes.arrays);
  return state;
}

}  // namespace lipofill::client
