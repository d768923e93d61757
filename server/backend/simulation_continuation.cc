#include "server/backend/simulation_continuation.h"

#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "lipofill/v1/simulation.pb.h"
#include "server/backend/parking.h"
#include "server/backend/simulation_creation.h"
#include "server/backend/simulation_ground.h"
#include "server/sessions/draining.h"
#include "server/sessions/identifiers.h"
#include "server/sessions/replay.h"
#include "server/store/ownership.h"
#include "server/store/record_names.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// A settled simulation in memory again, and what it takes with the injection.
struct Reopened {
  SimulationRecord record;
  v1::SimulationSpec spec;
  std::unique_ptr<simulation::Simulation> simulation;
  double wall_s = 0.0;
  simulation::ResolvedInjection injection;
};

absl::Status repeat_run(Ground& ground, SessionHistory history, uint64_t last_step, const Unwanted& unwanted) {
  simulation::Simulation& simulation = *ground.simulation;
  Replay replay(std::move(history), simulation.report().step);
  for (;;) {
    if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
    if (absl::Status repeated = replay.repeat(simulation); !repeated.ok()) return repeated;
    if (simulation.phase() != simulation::Phase::kRunning || simulation.report().step >= last_step) break;
    simulation.advance_step();
  }
  return absl::OkStatus();
}

absl::StatusOr<Reopened> reopen(Backend& backend, const std::string& id, const InjectionOrder& order,
                                const Unwanted& unwanted) {
  Reopened reopened;
  auto record = backend.store.get_simulation(id);
  if (!record.ok()) return record.status();
  if (record->state != SimulationState::kSettled) return no_session_for(backend, "inject", *record);
  reopened.record = *std::move(record);
  v1::Summary summary;
  if (!summary.ParseFromString(reopened.record.summary_message)) return absl::DataLossError("its figures are lost");
  if (order.check != nullptr) {
    if (absl::Status fits = order.check(); !fits.ok()) return fits;
  }
  const auto commands = backend.store.list_commands(id);
  if (!commands.ok()) return commands.status();
  auto ground = find_ground(backend, reopened.record, *commands);
  if (!ground.ok()) return ground.status();
  auto history = history_from(*ground, reopened.record, *commands);
  if (!history.ok()) return history.status();
  if (auto repeated = repeat_run(*ground, *std::move(history), summary.steps(), unwanted); !repeated.ok()) {
    return repeated;
  }
  if (ground->simulation->state_hash() != summary.state_hash()) {
    return absl::FailedPreconditionError(
        absl::StrCat("cannot inject: the run of ", simulation_name(id),
                     " does not come to the same state again, as it was made by another version of the daemon or on "
                     "another processor; create a simulation of its plan in its place"));
  }
  auto injection = ground->simulation->resolve(order.spec);
  if (!injection.ok()) return injection.status();
  reopened.spec = std::move(ground->spec);
  reopened.simulation = std::move(ground->simulation);
  reopened.wall_s = summary.wall_s();
  reopened.injection = *std::move(injection);
  return reopened;
}

}  // namespace

absl::StatusOr<std::shared_ptr<Session>> continue_simulation(Backend& backend, const std::string& id,
                                                             const InjectionOrder& order, const RequestKey& request,
                                                             const Unwanted& unwanted) {
  const std::lock_guard lock(backend.waking);
  const auto known = backend.keeper.was_kept(request);
  if (!known.ok()) return known.status();
  if (*known) return nullptr;
  TakenForNow taken_for_now(backend.store, id);
  if (absl::Status taken = take_ownership(backend.store, id); !taken.ok()) return taken;
  auto reopened = reopen(backend, id, order, unwanted);
  if (!reopened.ok()) return reopened.status();
  simulation::Simulation& simulation = *reopened->simulation;
  auto place = backend.sessions.reserve(reopened->record.tenant);
  if (!place.ok()) return place.status();
  if (auto room = place->claim(simulation.memory_bytes()); !room.ok()) return room;
  const auto epoch = backend.store.begin_epoch(id, now_us());
  if (!epoch.ok()) return epoch.status();
  const uint64_t step = simulation.report().step;
  const CommandRecord command{id, 0, CommandKind::kInject, step, order.message, now_us()};
  const auto kept = backend.keeper.keep_injection(command, *reopened->injection.spec.start, request);
  if (!kept.ok()) return kept.status();
  taken_for_now.keep();
  simulation.inject_resolved(reopened->injection);
  SessionHistory history;
  history.state = SimulationState::kRunning;
  history.wall_s = reopened->wall_s;
  const auto session =
      std::make_shared<Session>(make_session_options(backend, reopened->record, *epoch, reopened->spec),
                                std::move(reopened->simulation), backend.workers, backend.keeper, std::move(history));
  auto held = hold(session);
  if (!backend.sessions.add(*std::move(place), session)) return draining();
  held->go_on();
  spdlog::info("{} goes on from step {} with an injection", simulation_name(id), step);
  return held;
}

absl::StatusOr<plan::InjectionSpec> foresee_continuation(Backend& backend, const std::string& id,
                                                         const InjectionOrder& order, const Unwanted& unwanted) {
  const auto reopened = reopen(backend, id, order, unwanted);
  if (!reopened.ok()) return reopened.status();
  return reopened->injection.spec;
}

}  // namespace lipofill::server
