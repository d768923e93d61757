#include "server/backend/simulation_creation.h"

#include "absl/strings/str_cat.h"
#include "server/backend/await.h"
#include "server/backend/parking.h"
#include "server/sessions/draining.h"
#include "server/sessions/identifiers.h"
#include "server/store/record_names.h"
#include "server/wire/etag.h"
#include "server/wire/names.h"
#include "server/wire/report_conversion.h"
#include "server/wire/request_key.h"
#include "server/wire/simulation_conversion.h"
#include "server/wire/timestamps.h"
#include "server/wire/violation_prefix.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// A simulation that is to be made: its record, and its plan as the core takes it.
struct CreateOrder {
  SimulationRecord record;
  plan::SimulationSpec plan;
};

absl::StatusOr<CreateOrder> read_request(const Principal& caller, const v1::CreateSimulationRequest& request) {
  FieldViolations violations;
  violations.absorb("", check_request_id(request.request_id()));
  const auto id = id_or_new(request.simulation_id(), 'x', "simulation_id", caller.scope.tenant);
  violations.absorb("", id.status());
  violations.absorb("", check_display_name(request.display_name(), "display_name"));
  if (!request.has_spec()) violations.add("spec", "is missing");
  auto plan = to_simulation_spec(request.spec());
  if (request.has_spec()) violations.absorb("spec", plan.status());
  if (!request.spec().model().empty()) {
    violations.absorb("", parse_model_name(request.spec().model(), "spec.model").status());
  }
  if (!violations.empty()) return violations.to_status();
  CreateOrder order;
  SimulationRecord& record = order.record;
  record.id = *id;
  record.model = request.spec().model();
  record.display_name = request.display_name();
  record.spec_message = request.spec().SerializeAsString();
  record.create_time_us = now_us();
  record.tenant = caller.scope.tenant;
  order.plan = *std::move(plan);
  return order;
}

/// Shows a simulation that is only to be checked as it would be once created.
absl::StatusOr<v1::Simulation> show_checked(Backend& backend, const SimulationRecord& record,
                                            const v1::SimulationSpec& spec,
                                            std::unique_ptr<simulation::Simulation> simulation) {
  if (backend.store.get_simulation(record.id).ok()) {
    return absl::AlreadyExistsError(absl::StrCat(simulation_name(record.id), " exists"));
  }
  const Session session(make_session_options(backend, record, 0, spec), std::move(simulation), backend.workers,
                        backend.keeper);
  const SessionView view = session.cached_view();
  return to_simulation(record, &view);
}

absl::StatusOr<SessionView> start_and_wait(Session& session) {
  return await<absl::StatusOr<SessionView>>([&session](auto reply) { session.start({}, std::move(reply)); });
}

}  // namespace

v1::Simulation to_simulation(const SimulationRecord& record, const SessionView* view) {
  v1::Simulation simulation;
  simulation.set_name(simulation_name(record.id));
  simulation.set_display_name(record.display_name);
  simulation.set_origin(record.origin);
  simulation.set_etag(make_etag(record));
  simulation.mutable_spec()->ParseFromString(record.spec_message);
  *simulation.mutable_create_time() = to_timestamp(record.create_time_us);
  simulation.set_state(to_state(view != nullptr ? view->state : record.state));
  if (view != nullptr && view->state == SimulationState::kRunning && view->queue_position > 0) {
    simulation.set_state(v1::Simulation::QUEUED);
    simulation.set_queue_position(static_cast<uint32_t>(view->queue_position));
  }
  simulation.set_reason(view != nullptr ? view->reason : record.reason);
  if (view != nullptr && !view->unkept.empty()) {
    simulation.set_reason(
        absl::StrCat(view->reason, view->reason.empty() ? "" : "; ",
                     "the result is not kept yet, and would be computed again if the daemon died: ", view->unkept));
  }
  if (view != nullptr) {
    *simulation.mutable_summary() = to_summary(*view);
    simulation.set_viewers(static_cast<uint32_t>(view->viewers));
    if (view->catching_up_to) simulation.mutable_recovery()->set_until_step(*view->catching_up_to);
  } else {
    simulation.mutable_summary()->ParseFromString(record.summary_message);
    simulation.set_parked(is_parked(record));
  }
  return simulation;
}

v1::Simulation show_without_session(const Backend& backend, const SimulationRecord& record) {
  v1::Simulation simulation = to_simulation(record, nullptr);
  const auto awaited = backend.awaited.find(record.id);
  if (!awaited || has_ended(record.state)) return simulation;
  simulation.set_reason(
      absl::StrCat("it is not back since the daemon was started again: it waits for this: ", awaited->waiting_for));
  v1::Recovery& recovery = *simulation.mutable_recovery();
  recovery.set_until_step(awaited->until_step);
  recovery.set_waiting_for(awaited->waiting_for);
  recovery.set_attempts(awaited->attempts);
  const auto delay_us = static_cast<int64_t>(1e6 * awaited->delay().count());
  *recovery.mutable_next_attempt_time() = to_timestamp(now_us() + delay_us);
  return simulation;
}

absl::StatusOr<v1::Simulation> show_simulation(Backend& backend, const std::string& id) {
  const auto record = backend.store.get_simulation(id);
  if (!record.ok()) return record.status();
  const auto session = backend.sessions.find(id);
  if (session == nullptr) return show_without_session(backend, *record);
  const SessionView view = session->cached_view();
  return to_simulation(*record, &view);
}

absl::StatusOr<std::unique_ptr<simulation::Simulation>> make_simulation(Backend& backend, const std::string& model,
                                                                        plan::SimulationSpec plan) {
  const auto built = backend.load_model(model);
  if (!built.ok()) return built.status();
  auto made = simulation::Simulation::create(*built, std::move(plan));
  if (!made.ok()) return with_prefix("spec", made.status());
  return made;
}

absl::StatusOr<std::unique_ptr<simulation::Simulation>> make_simulation(Backend& backend, const std::string& model,
                                                                        const v1::SimulationSpec& spec) {
  auto plan = to_simulation_spec(spec);
  if (!plan.ok()) return plan.status();
  return make_simulation(backend, model, *std::move(plan));
}

SessionOptions make_session_options(const Backend& backend, const SimulationRecord& record, uint64_t epoch,
                                    const v1::SimulationSpec& spec) {
  SessionOptions options;
  options.id = record.id;
  options.tenant = record.tenant;
  options.epoch = epoch;
  options.real_time = spec.pace() == v1::REAL_TIME;
  options.preview = spec.preview();
  options.checkpoint_interval_s = backend.options.checkpoints.interval_s;
  return options;
}

absl::StatusOr<v1::Simulation> open_session(Backend& backend, SessionManager::Place place,
                                            const SimulationRecord& record, std::shared_ptr<Session> session,
                                            bool start) {
  const auto ids = parse_model_name(record.model, "spec.model");
  // The record holds the model from here on, but the model may have gone before that.
  const auto held = hold(session);
  absl::Status open = ids.ok() ? backend.store.get_model(ids->patient, ids->id).status() : ids.status();
  if (open.ok() && !backend.sessions.add(std::move(place), session)) {
    open = draining();
  }
  if (!open.ok()) {
    delete_simulation_record(backend, record.id).IgnoreError();
    return open;
  }
  SessionView view = session->cached_view();
  spdlog::info("{} created on {}, {} degrees of freedom, {} film cells", simulation_name(record.id), record.model,
               view.n_dofs, view.n_film_cells);
  if (!start) return to_simulation(record, &view);
  auto started = start_and_wait(*session);
  if (!started.ok()) return started.status();
  return to_simulation(record, &*started);
}

absl::StatusOr<v1::Simulation> show_made_before(Backend& backend, const std::string& name, bool start) {
  const std::string id = name.substr(simulation_name("").size());
  const auto session = start ? find_or_wake(backend, id) : nullptr;
  if (session.ok() && *session != nullptr && (*session)->cached_view().state == SimulationState::kReady) {
    // The daemon ended between making it and starting it; another repetition may be first.
    start_and_wait(**session).status().IgnoreError();
  }
  return show_simulation(backend, id);
}

absl::Status delete_simulation_record(Backend& backend, const std::string& id, const std::string& etag) {
  const auto record = backend.store.get_simulation(id);
  // What is damaged can go, unless it is to be checked first.
  if (!record.ok() && (!absl::IsDataLoss(record.status()) || !etag.empty())) return record.status();
  if (record.ok()) {
    if (absl::Status fits = check_etag(etag, make_etag(*record), "etag"); !fits.ok()) return fits;
  }
  const absl::Status done = backend.reserve.spend([&] { return backend.store.delete_simulation(id); });
  if (!done.ok()) return done;
  backend.sessions.remove(id);
  backend.awaited.forget(id);
  backend.temporary_files.remove_deleted();
  spdlog::info("{} deleted", simulation_name(id));
  return done;
}

absl::StatusOr<v1::Simulation> create_simulation(Backend& backend, const Principal& caller,
                                                 const v1::CreateSimulationRequest& request, const Unwanted& unwanted) {
  auto order = read_request(caller, request);
  if (!order.ok()) return order.status();
  const SimulationRecord& record = order->record;
  const RequestKey key = make_request_key(caller, "CreateSimulation", request.request_id(), request);
  const auto earlier = backend.store.find_request(key);
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return show_made_before(backend, **earlier, request.start());

  if (absl::Status small = check_size(request.spec(), backend.options.sizes); !small.ok()) return small;
  auto place = backend.sessions.reserve(record.tenant);
  if (!place.ok()) return place.status();
  auto simulation = make_simulation(backend, record.model, std::move(order->plan));
  if (!simulation.ok()) return simulation.status();
  if (absl::Status room = place->claim((*simulation)->memory_bytes()); !room.ok()) return room;
  if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
  if (request.validate_only()) return show_checked(backend, record, request.spec(), *std::move(simulation));
  const auto kept = backend.store.create_simulation(record, key);
  if (!kept.ok()) return kept.status();
  if (kept->id != record.id) return show_made_before(backend, simulation_name(kept->id), request.start());
  const auto epoch = static_cast<uint64_t>(record.create_time_us);
  auto session = std::make_shared<Session>(make_session_options(backend, record, epoch, request.spec()),
                                           *std::move(simulation), backend.workers, backend.keeper);
  return open_session(backend, *std::move(place), record, std::move(session), request.start());
}

}  // namespace lipofill::server
