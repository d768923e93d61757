#include "server/backend/simulation_recovery.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/backend/guarded.h"
#include "server/backend/parking.h"
#include "server/backend/simulation_creation.h"
#include "server/backend/simulation_ground.h"
#include "server/sessions/draining.h"
#include "server/sessions/identifiers.h"
#include "server/store/ownership.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// A session that others do not find yet.
struct Revived {
  std::shared_ptr<Session> session;
  uint64_t bytes = 0;  ///< it takes in memory
};

/// Makes what a simulation goes on with, in a new epoch. It is this daemon's from here on, before
/// its commands are read: nobody else adds one to them.
absl::StatusOr<Revived> revive(Backend& backend, const SimulationRecord& record) {
  if (absl::Status taken = take_ownership(backend.store, record.id); !taken.ok()) return taken;
  const auto commands = backend.store.list_commands(record.id);
  if (!commands.ok()) return commands.status();
  auto ground = find_ground(backend, record, *commands);
  if (!ground.ok()) return ground.status();
  auto history = history_from(*ground, record, *commands);
  if (!history.ok()) return history.status();
  const uint64_t step = ground->checkpoint.step;
  if (auto cut = backend.store.cut_series(record.id, step); !cut.ok()) return cut;
  const auto epoch = backend.store.begin_epoch(record.id, now_us());
  if (!epoch.ok()) return epoch.status();
  spdlog::info("{} is {} and goes on from step {}{}", simulation_name(record.id), state_name(record.state), step,
               history->until_step > step ? absl::StrCat(", catching up to step ", history->until_step) : "");
  const uint64_t bytes = ground->simulation->memory_bytes();
  const auto session =
      std::make_shared<Session>(make_session_options(backend, record, *epoch, ground->spec),
                                std::move(ground->simulation), backend.workers, backend.keeper, *std::move(history));
  return Revived{session, bytes};
}

absl::Status bring_back(Backend& backend, const SimulationRecord& record) {
  auto revived = revive(backend, record);
  if (!revived.ok()) return revived.status();
  // The summary it was parked with soon no longer holds.
  if (auto cleared = backend.store.keep_summary(record.id, ""); !cleared.ok()) return cleared;
  if (!backend.sessions.bring_back(record.tenant, revived->bytes, std::move(revived->session))) return draining();
  backend.awaited.forget(record.id);
  return absl::OkStatus();
}

/// The step at which the last command of a simulation took effect.
uint64_t last_step_of(Backend& backend, const SimulationRecord& record) {
  const auto commands = backend.store.list_commands(record.id);
  uint64_t step = 0;
  if (!commands.ok()) return step;
  for (const CommandRecord& command : *commands) step = std::max(step, command.step);
  return step;
}

void note_waiting(Backend& backend, const SimulationRecord& record, const std::string& waiting_for) {
  backend.awaited.note(record.id, waiting_for, last_step_of(backend, record));
  const auto awaited = backend.awaited.find(record.id);
  spdlog::warn("{} could not be brought back: {}; the next attempt is in {:.0f} s", simulation_name(record.id),
               waiting_for, awaited ? awaited->delay().count() : 0.0);
}

/// A simulation whose plan or log is lost has failed; one that met a shortage, or for which a file
/// is missing, waits. One that another daemon owns is none of this one's.
void note_failure(Backend& backend, const SimulationRecord& record, const absl::Status& why) {
  if (is_owned_elsewhere(why)) return backend.awaited.forget(record.id);
  const bool is_lost = absl::IsDataLoss(why) || absl::IsNotFound(why) || absl::IsInvalidArgument(why);
  if (!is_lost) return note_waiting(backend, record, std::string(why.message()));
  const std::string reason =
      absl::StrCat("it cannot go on after the daemon was started again: ", std::string(why.message()));
  const absl::Status told = backend.store.set_simulation_state(record.id, SimulationState::kFailed, reason);
  if (!told.ok()) return note_waiting(backend, record, std::string(told.message()));
  spdlog::error("{}: {}", simulation_name(record.id), reason);
  backend.awaited.forget(record.id);
}

}  // namespace

absl::Status bring_back_simulations(Backend& backend) {
  const auto records = backend.store.list_unended_simulations();
  if (!records.ok()) return records.status();
  std::atomic<size_t> next = 0;
  const auto work = [&] {
    for (size_t i = next++; i < records->size(); i = next++) {
      const SimulationRecord& record = (*records)[i];
      if (record.is_damaged) spdlog::error("{}", std::string(damaged_record(simulation_name(record.id)).message()));
      if (record.is_damaged || is_parked(record)) continue;
      const absl::Status back = guarded([&] { return bring_back(backend, record); });
      if (!back.ok()) note_failure(backend, record, back);
    }
  };
  std::vector<std::thread> threads;
  const size_t n_threads = std::min(records->size(), static_cast<size_t>(backend.workers.n_workers()));
  for (size_t i = 0; i < n_threads; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  return absl::OkStatus();
}

void try_to_bring_back(Backend& backend, const std::string& id) {
  const std::lock_guard lock(backend.waking);
  const auto record = backend.store.get_simulation(id);
  const bool is_gone = absl::IsNotFound(record.status()) || (record.ok() && has_ended(record->state));
  if (is_gone || backend.sessions.find(id) != nullptr) return backend.awaited.forget(id);
  SimulationRecord known;
  known.id = id;
  if (record.ok()) known = *record;
  const absl::Status back =
      record.ok() ? guarded([&] { return bring_back(backend, known); }) : waits_for(record.status());
  if (!back.ok()) note_failure(backend, known, back);
}

absl::StatusOr<std::shared_ptr<Session>> wake_simulation(Backend& backend, const SimulationRecord& record) {
  auto place = backend.sessions.reserve(record.tenant);
  if (!place.ok()) return place.status();
  TakenForNow taken_for_now(backend.store, record.id);
  auto revived = revive(backend, record);
  if (!revived.ok()) return revived.status();
  if (auto room = place->claim(revived->bytes); !room.ok()) return room;
  if (auto cleared = backend.store.keep_summary(record.id, ""); !cleared.ok()) return cleared;
  taken_for_now.keep();
  auto held = hold(revived->session);
  if (!backend.sessions.add(*std::move(place), revived->session)) return draining();
  held->go_on();
  spdlog::info("{} is in memory again", simulation_name(record.id));
  return held;
}

}  // namespace lipofill::server
