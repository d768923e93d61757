#include "server/rpc/simulation_creation.h"

#include <future>

#include "server/rpc/names.h"
#include "server/rpc/report_conversion.h"
#include "server/rpc/request_key.h"
#include "server/rpc/simulation_conversion.h"
#include "server/rpc/timestamps.h"
#include "server/rpc/violation_prefix.h"
#include "server/sessions/identifiers.h"
#include "server/store/sqlite_store.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

absl::StatusOr<SimulationRecord> read_request(const v1::CreateSimulationRequest& request) {
  FieldViolations violations;
  violations.absorb("", check_request_id(request.request_id()));
  const auto id = id_or_new(request.simulation_id(), 'x', "simulation_id");
  violations.absorb("", id.status());
  violations.absorb("", check_display_name(request.display_name(), "display_name"));
  if (!request.has_spec()) violations.add("spec", "is missing");
  if (request.has_spec()) violations.absorb("spec", to_simulation_spec(request.spec()).status());
  if (!request.spec().model().empty()) {
    violations.absorb("", parse_model_name(request.spec().model(), "spec.model").status());
  }
  if (!violations.empty()) return violations.to_status();
  SimulationRecord record;
  record.id = *id;
  record.model = request.spec().model();
  record.display_name = request.display_name();
  record.spec_message = request.spec().SerializeAsString();
  record.create_time_us = now_us();
  return record;
}

absl::StatusOr<std::shared_ptr<Session>> make_session(Backend& backend, const SimulationRecord& record,
                                                      const v1::SimulationSpec& message) {
  const auto model = backend.load_model(record.model);
  if (!model.ok()) return model.status();
  auto spec = to_simulation_spec(message);
  if (!spec.ok()) return spec.status();
  auto simulation = simulation::Simulation::create(*model, *std::move(spec));
  if (!simulation.ok()) return with_prefix("spec", simulation.status());
  SessionOptions options;
  options.id = record.id;
  options.epoch = static_cast<uint64_t>(record.create_time_us);
  options.real_time = message.pace() == v1::REAL_TIME;
  options.preview = message.preview();
  return std::make_shared<Session>(options, *std::move(simulation), backend.workers, backend.keeper);
}

absl::StatusOr<v1::Simulation> show(Backend& backend, const std::string& id) {
  const auto record = backend.store.get_simulation(id);
  if (!record.ok()) return record.status();
  const auto session = backend.sessions.find(id);
  if (session == nullptr) return to_simulation(*record, nullptr);
  const SessionView view = session->cached_view();
  return to_simulation(*record, &view);
}

absl::StatusOr<SessionView> start(Session& session) {
  auto answer = std::make_shared<std::promise<absl::StatusOr<SessionView>>>();
  session.start([answer](absl::StatusOr<SessionView> view) { answer->set_value(std::move(view)); });
  return answer->get_future().get();
}

}  // namespace

v1::Simulation to_simulation(const SimulationRecord& record, const SessionView* view) {
  v1::Simulation simulation;
  simulation.set_name(simulation_name(record.id));
  simulation.set_display_name(record.display_name);
  simulation.mutable_spec()->ParseFromString(record.spec_message);
  *simulation.mutable_create_time() = to_timestamp(record.create_time_us);
  simulation.set_state(to_state(view != nullptr ? view->state : record.state));
  simulation.set_reason(view != nullptr ? view->reason : record.reason);
  if (view != nullptr) {
    *simulation.mutable_summary() = to_summary(*view);
  } else {
    simulation.mutable_summary()->ParseFromString(record.summary_message);
  }
  return simulation;
}

absl::StatusOr<v1::Simulation> create_simulation(Backend& backend, const v1::CreateSimulationRequest& request,
                                                 const std::function<bool()>& caller_has_left) {
  const auto record = read_request(request);
  if (!record.ok()) return record.status();
  const RequestKey key = make_request_key("CreateSimulation", request.request_id(), request);
  const auto earlier = backend.store.find_request(key);
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return show(backend, (**earlier).substr(simulation_name("").size()));

  auto place = backend.sessions.reserve();
  if (!place.ok()) return place.status();
  const auto session = make_session(backend, *record, request.spec());
  if (!session.ok()) return session.status();
  if (caller_has_left()) return absl::CancelledError("the caller left before the simulation was created");
  const auto kept = backend.store.create_simulation(*record, key);
  if (!kept.ok()) return kept.status();
  if (kept->id != record->id) return show(backend, kept->id);
  if (!backend.sessions.add(*std::move(place), *session)) {
    backend.store.delete_simulation(record->id).IgnoreError();
    return absl::UnavailableError("the daemon is stopping");
  }
  SessionView view = (*session)->cached_view();
  spdlog::info("{} created on {}, {} degrees of freedom, {} film cells", simulation_name(record->id), record->model,
               view.n_dofs, view.n_film_cells);
  if (!request.start()) return to_simulation(*record, &view);
  auto started = start(**session);
  if (!started.ok()) return started.status();
  return to_simulation(*record, &*started);
}

}  // namespace lipofill::server
