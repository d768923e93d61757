#include "server/backend/simulation_ground.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/backend/checkpoint_loading.h"
#include "server/backend/simulation_creation.h"
#include "server/store/record_names.h"
#include "server/wire/simulation_conversion.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

constexpr int kMostCheckpoints = 10'000;

bool is_about_the_checkpoint(const absl::Status& status) {
  return absl::IsDataLoss(status) || absl::IsNotFound(status);
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

}  // namespace

absl::Status waits_for(const absl::Status& why) {
  return absl::UnavailableError(std::string(why.message()));
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

}  // namespace lipofill::server
