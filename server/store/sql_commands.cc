#include "absl/strings/str_cat.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/store/sql_store.h"

namespace lipofill::server {
namespace {

/// The state that a command leads to. STOPPED is not among them: a simulation has ended once its
/// result is kept. One that has settled goes on with an injection.
SimulationState state_after(CommandKind kind, SimulationState before) {
  if (kind == CommandKind::kStart || kind == CommandKind::kResume) return SimulationState::kRunning;
  if (kind == CommandKind::kPause) return SimulationState::kPaused;
  if (kind == CommandKind::kInject && before == SimulationState::kSettled) return SimulationState::kRunning;
  return before;
}

/// Forgets what was said of the end of a simulation that goes on.
absl::Status forget_end(Database& database, const std::string& simulation) {
  Query update(database, "UPDATE simulations SET reason = x'', summary = x'' WHERE id = ?");
  return update.bind(simulation).run();
}

}  // namespace

absl::StatusOr<bool> SqlStore::append_command(const CommandRecord& command, const std::string& spec_message,
                                              const RequestKey& request) {
  const auto earlier = transact_once(request, simulation_name(command.simulation), [&]() -> absl::Status {
    if (absl::Status owned = fence_.check(command.simulation); !owned.ok()) return owned;
    const auto simulation = read_simulation(command.simulation);
    if (!simulation.ok()) return simulation.status();
    absl::Status done = write_command(command);
    const SimulationState state = state_after(command.kind, simulation->state);
    done.Update(write_state(command.simulation, state, spec_message.empty() ? simulation->spec_message : spec_message));
    if (has_ended(simulation->state) && !has_ended(state)) done.Update(forget_end(*database_, command.simulation));
    return done;
  });
  if (!earlier.ok()) return earlier.status();
  return !earlier->has_value();
}

absl::Status SqlStore::write_command(const CommandRecord& command) {
  const auto last = read_last_command(command.simulation);
  if (!last.ok()) return last.status();
  Query insert(*database_, "INSERT INTO simulation_commands (" COMMAND_COLUMNS ") VALUES (?, ?, ?, ?, ?, 1, ?)");
  return insert
      .bind(command.simulation, *last + 1, static_cast<int>(command.kind), command.step, command.payload,
            command.create_time_us)
      .run();
}

absl::StatusOr<uint64_t> SqlStore::read_last_command(const std::string& simulation) {
  Query query(*database_, "SELECT coalesce(max(number), 0) FROM simulation_commands WHERE simulation = ?");
  const uint64_t last = query.bind(simulation).next() ? query.unsigned_integer(0) : 0;
  if (!query.status().ok()) return query.status();
  return last;
}

absl::Status SqlStore::write_state(const std::string& simulation, SimulationState state,
                                   const std::string& spec_message) {
  Query update(*database_, "UPDATE simulations SET state = ?, spec = ? WHERE id = ?");
  return update.bind(static_cast<int>(state), spec_message, simulation).run();
}

absl::StatusOr<std::vector<CommandRecord>> SqlStore::list_commands(const std::string& simulation) {
  return turns_.look([&]() -> absl::StatusOr<std::vector<CommandRecord>> {
    Query query(*database_,
                "SELECT number, kind, step, payload, create_time_us, " IS_WHOLE(
                    "simulation_commands", COMMAND_COLUMNS) " FROM simulation_commands "
                "WHERE simulation = ? AND on_course = 1 ORDER BY number");
    query.bind(simulation);
    std::vector<CommandRecord> commands;
    while (query.next()) {
      if (!query.is_true(5)) return damaged_record(absl::StrCat(simulation_name(simulation), " (its commands)"));
      commands.push_back({simulation, query.unsigned_integer(0), static_cast<CommandKind>(query.integer(1)),
                          query.unsigned_integer(2), query.text(3), query.integer(4)});
    }
    if (!query.status().ok()) return query.status();
    return commands;
  });
}

absl::StatusOr<bool> SqlStore::restore_simulation(const CommandRecord& restore, SimulationState state,
                                                  const std::string& spec_message, const RequestKey& request) {
  const auto earlier = transact_once(request, simulation_name(restore.simulation),
                                     [&] { return write_restore(restore, state, spec_message); });
  if (!earlier.ok()) return earlier.status();
  return !earlier->has_value();
}

absl::Status SqlStore::write_restore(const CommandRecord& restore, SimulationState state,
                                     const std::string& spec_message) {
  const std::string& id = restore.simulation;
  if (absl::Status owned = fence_.check(id); !owned.ok()) return owned;
  const auto checkpoint = read_checkpoint(id, restore.payload);
  if (!checkpoint.ok()) return checkpoint.status();
  if (!checkpoint->on_course) {
    return absl::FailedPreconditionError(absl::StrCat(checkpoint_name(id, restore.payload), " lies on a course that ",
                                                      simulation_name(id),
                                                      " has left; a new simulation can begin from it"));
  }
  Query commands(*database_, "UPDATE simulation_commands SET on_course = 0 WHERE simulation = ? AND number > ?");
  absl::Status done = commands.bind(id, checkpoint->last_command).run();
  Query later(*database_,
              "UPDATE checkpoints SET on_course = 0 WHERE simulation = ? AND (step > ? OR last_command > ?)");
  done.Update(later.bind(id, checkpoint->step, checkpoint->last_command).run());
  done.Update(erase_rows(id, checkpoint->step));
  done.Update(write_command(restore));
  if (state != SimulationState::kReady) {
    const CommandKind goes_on = state == SimulationState::kRunning ? CommandKind::kResume : CommandKind::kPause;
    done.Update(write_command({id, 0, goes_on, restore.step, "", restore.create_time_us}));
  }
  done.Update(write_state(id, state, spec_message));
  return done;
}

}  // namespace lipofill::server
