#include "server/backend/simulation_recovery.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/backend/checkpoint_loading.h"
#include "server/backend/guarded.h"
#include "server/backend/parking.h"
#include "server/backend/simulation_creation.h"
#include "server/sessions/draining.h"
#include "server/sessions/identifiers.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/wire/simulation_conversion.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

constexpr int kMostCheckpoints = 10'000;

/// The state a simulation goes on from.
struct Ground {
  std::unique_ptr<simulation::Simulation> simulation;
  v1::SimulationSpec spec;
  CheckpointRecord checkpoint;  ///< is the start where it has step 0 and no command
  std::string note;             ///< which checkpoints could not be used
};

/// A session that others do not find yet.
struct Revived {
  std::shared_ptr<Session> session;
  uint64_t bytes = 0;  ///< it takes in memory
};

bool is_about_the_checkpoint(const absl::Status& status) {
  return absl::IsDataLoss(status) || absl::IsNotFound(status);
}

/// For what may be there another time: a model that cannot be built for want of memory or of a
/// file, a file that is put back. What the store itself holds does not come back.
absl::Status waits_for(const absl::Status& why) {
  return absl::UnavailableError(std::string(why.message()));
}

/// Checkpoints on course, newest first.
absl::StatusOr<std::vector<CheckpointRecord>> list_candidates(Backend& backend, const std::string& id) {
  auto all = backend.store.list_checkpoints(id, {"", kMostCheckpoints});
  if (!all.ok()) return all;
  std::erase_if(*all, [](const CheckpointRecord& c) { return c.is_damaged || !c.on_course; });
  std::sort(all->begin(), all->end(), [](const CheckpointRecord& a, const CheckpointRecord& b) {
    return std::tie(a.last_command, a.step, a.create_time_us) > std::tie(b.last_command, b.step, b.create_time_us);
  });
  return all;
}

/// Clients' checkpoints stay, to answer for themselves; the daemon's own are of no use any more.
void note_unusable(Backend& backend, const CheckpointRecord& checkpoint, const absl::Status& why, std::string& note) {
  spdlog::error("{}: {}", simulation_name(checkpoint.simulation), why.ToString());
  absl::StrAppend(&note, note.empty() ? "" : "; ", std::string(why.message()));
  if (checkpoint.kind != CheckpointKind::kAutomatic) return;
  if (backend.store.delete_checkpoint(checkpoint.simulation, checkpoint.id).ok()) {
    backend.temporary_files.remove_deleted();
  }
}

/// The plan as it was before the injections of the log.
absl::StatusOr<v1::SimulationSpec> plan_at_start(const SimulationRecord& record,
                                                 const std::vector<CommandRecord>& commands) {
  v1::SimulationSpec spec;
  if (!spec.ParseFromString(record.spec_message)) return absl::DataLossError("its plan cannot be read");
  const auto later = std::count_if(commands.begin(), commands.end(),
                                   [](const CommandRecord& c) { return c.kind == CommandKind::kInject; });
  const int first = spec.injections_size() - static_cast<int>(later);
  if (first < 0) return absl::DataLossError("its plan does not go with its log");
  spec.mutable_injections()->DeleteSubrange(first, static_cast<int>(later));
  return spec;
}

absl::StatusOr<Ground> find_ground(Backend& backend, const SimulationRecord& record,
                                   const std::vector<CommandRecord>& commands) {
  // No checkpoint is any good without the model, and none is to blame.
  if (auto model = backend.load_model(record.model); !model.ok()) return waits_for(model.status());
  const auto candidates = list_candidates(backend, record.id);
  if (!candidates.ok()) return candidates.status();
  Ground ground;
  for (const CheckpointRecord& candidate : *candidates) {
    auto loaded = load_checkpoint(backend, candidate, record.model);
    if (loaded.ok()) {
      ground.simulation = std::move(loaded->simulation);
      ground.spec = std::move(loaded->spec);
      ground.checkpoint = candidate;
      return ground;
    }
    if (!is_about_the_checkpoint(loaded.status())) return loaded.status();
    note_unusable(backend, candidate, loaded.status(), ground.note);
  }
  if (!record.origin.empty()) {
    return waits_for(absl::DataLossError(absl::StrCat("it began from ", record.origin, "; ", ground.note)));
  }
  auto spec = plan_at_start(record, commands);
  if (!spec.ok()) return spec.status();
  auto simulation = make_simulation(backend, record.model, *spec);
  if (!simulation.ok()) return simulation.status();
  ground.simulation = *std::move(simulation);
  ground.spec = *std::move(spec);
  return ground;
}

/// Collects the commands that were acknowledged after the checkpoint the simulation goes on from.
absl::StatusOr<SessionHistory> history_from(const Ground& ground, const SimulationRecord& record,
                                            const std::vector<CommandRecord>& commands) {
  SessionHistory history;
  history.state = record.state;
  history.was_there = true;
  history.last_command = ground.checkpoint.last_command;
  history.wall_s = ground.checkpoint.wall_s;
  if (!ground.note.empty()) {
    history.note = absl::StrCat("goes on from step ", ground.checkpoint.step, ": ", ground.note);
  }
  for (const CommandRecord& command : commands) {
    if (command.number <= ground.checkpoint.last_command) continue;
    history.commands.push_back({command.number, command.step});
    history.until_step = std::max(history.until_step, command.step);
    if (command.kind == CommandKind::kStop) history.stop_reason = command.payload;
    if (command.kind != CommandKind::kInject) continue;
    v1::Injection message;
    if (!message.ParseFromString(command.payload)) return absl::DataLossError("an injection of its log cannot be read");
    const auto injection = to_injection_spec(message);
    if (!injection.ok()) return absl::DataLossError(std::string(injection.status().message()));
    history.injections.push_back({command.step, *injection});
  }
  return history;
}

/// Makes what a simulation goes on with, in a new epoch.
absl::StatusOr<Revived> revive(Backend& backend, const SimulationRecord& record) {
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
/// is missing, waits.
void note_failure(Backend& backend, const SimulationRecord& record, const absl::Status& why) {
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
  auto revived = revive(backend, record);
  if (!revived.ok()) return revived.status();
  if (auto room = place->claim(revived->bytes); !room.ok()) return room;
  if (auto cleared = backend.store.keep_summary(record.id, ""); !cleared.ok()) return cleared;
  auto held = hold(revived->session);
  if (!backend.sessions.add(*std::move(place), revived->session)) return draining();
  held->go_on();
  spdlog::info("{} is in memory again", simulation_name(record.id));
  return held;
}

}  // namespace lipofill::server
