#include <algorithm>

#include "absl/strings/str_cat.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/store/scope_query.h"
#include "server/store/sql_store.h"

namespace lipofill::server {
namespace {

/// Those that a record has; the epoch is the store's own.
#define RECORD_COLUMNS "id, model, display_name, spec, state, reason, summary, create_time_us, origin, tenant"
#define SIMULATION_IS_WHOLE IS_WHOLE("simulations", SIMULATION_COLUMNS)
#define LAST_COMMAND "(SELECT coalesce(max(number), 0) FROM simulation_commands WHERE simulation = id)"
/// The id in "patients/{patient}/models/{model}".
#define PATIENT_OF_MODEL "substr(model, 10, instr(substr(model, 10), x'2f') - 1)"

SimulationRecord simulation_of(const Query& row) {
  SimulationRecord simulation;
  simulation.id = row.text(0);
  simulation.model = row.text(1);
  simulation.display_name = row.text(2);
  simulation.spec_message = row.text(3);
  simulation.state = static_cast<SimulationState>(row.integer(4));
  simulation.reason = row.text(5);
  simulation.summary_message = row.text(6);
  simulation.create_time_us = row.integer(7);
  simulation.origin = row.text(8);
  simulation.tenant = row.text(9);
  simulation.last_command = row.unsigned_integer(10);
  return simulation;
}

/// A row of a list: one that is damaged is named and no more.
SimulationRecord listed_simulation_of(const Query& row) {
  if (row.is_true(11)) return simulation_of(row);
  SimulationRecord damaged;
  damaged.id = row.text(0);
  damaged.is_damaged = true;
  return damaged;
}

absl::Status no_simulation(const std::string& id) {
  return absl::NotFoundError(absl::StrCat("there is no ", simulation_name(id)));
}

absl::Status write_result(Database& database, const std::string& simulation, const SimulationResult& result) {
  Query clear(database, "DELETE FROM simulation_results WHERE simulation = ?");
  absl::Status done = clear.bind(simulation).run();
  // It is summed here, not by the trigger, which would write these megabytes twice.
  Query insert(database, "INSERT INTO simulation_results (" RESULT_COLUMNS
                         ", sum) VALUES (?1, ?2, ?3, row_sum('simulation_results', CAST(?1 AS BLOB), "
                         "CAST(?2 AS BLOB), CAST(?3 AS BLOB)))");
  done.Update(insert.bind(simulation, result.meshes_message, result.frame_message).run());
  return done;
}

}  // namespace

absl::StatusOr<SimulationRecord> SqlStore::create_simulation(const SimulationRecord& simulation,
                                                             const RequestKey& request) {
  return make_simulation(simulation, nullptr, request);
}

absl::StatusOr<SimulationRecord> SqlStore::create_simulation_from(const SimulationRecord& simulation,
                                                                  const CheckpointRecord& origin,
                                                                  const RequestKey& request) {
  return make_simulation(simulation, &origin, request);
}

absl::StatusOr<SimulationRecord> SqlStore::make_simulation(const SimulationRecord& simulation,
                                                           const CheckpointRecord* origin, const RequestKey& request) {
  const auto earlier = transact_once(request, simulation_name(simulation.id), [&] {
    absl::Status written = write_simulation(simulation);
    if (written.ok()) written = fence_.write_owner(simulation.id);
    return written.ok() && origin != nullptr ? write_checkpoint(*origin) : written;
  });
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return get_simulation((**earlier).substr(simulation_name("").size()));
  return simulation;
}

absl::Status SqlStore::write_simulation(const SimulationRecord& simulation) {
  Query insert(*database_, "INSERT INTO simulations (" RECORD_COLUMNS ") VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  const absl::Status done = insert
                                .bind(simulation.id, simulation.model, simulation.display_name, simulation.spec_message,
                                      static_cast<int>(simulation.state), simulation.reason, simulation.summary_message,
                                      simulation.create_time_us, simulation.origin, simulation.tenant)
                                .run();
  if (!absl::IsAlreadyExists(done)) return done;
  return absl::AlreadyExistsError(absl::StrCat(simulation_name(simulation.id), " exists"));
}

absl::StatusOr<SimulationRecord> SqlStore::get_simulation(const std::string& id) {
  return turns_.look([&] { return read_simulation(id); });
}

absl::StatusOr<SimulationRecord> SqlStore::read_simulation(const std::string& id) {
  Query query(*database_,
              "SELECT " RECORD_COLUMNS ", " LAST_COMMAND ", " SIMULATION_IS_WHOLE " FROM simulations WHERE id = ?");
  if (!query.bind(id).next()) return query.status().ok() ? no_simulation(id) : query.status();
  if (!query.is_true(11)) return damaged_record(simulation_name(id));
  return simulation_of(query);
}

absl::StatusOr<Owner> SqlStore::owner_of_simulation(const std::string& id) {
  return turns_.look([&]() -> absl::StatusOr<Owner> {
    if (const auto known = owners_.find(id); known != owners_.end()) return known->second;
    Query query(*database_,
                "SELECT tenant, " PATIENT_OF_MODEL ", " SIMULATION_IS_WHOLE " FROM simulations WHERE id = ?");
    if (!query.bind(id).next()) return query.status().ok() ? no_simulation(id) : query.status();
    if (!query.is_true(2)) return damaged_record(simulation_name(id));
    const Owner owner{query.text(0), query.text(1)};
    if (!database_->is_shared()) owners_[id] = owner;
    return owner;
  });
}

absl::StatusOr<std::vector<SimulationRecord>> SqlStore::list_simulations(const Scope& scope, const Page& page) {
  return turns_.look([&]() -> absl::StatusOr<std::vector<SimulationRecord>> {
    Query query(*database_, "SELECT " RECORD_COLUMNS ", " LAST_COMMAND ", " SIMULATION_IS_WHOLE
                            " FROM simulations WHERE tenant = ?1 AND id > ?2 AND " IS_AMONG(
                                PATIENT_OF_MODEL, "?3", "?4") " ORDER BY id LIMIT ?5");
    query.bind(scope.tenant, page.after, !scope.patients, patients_of(scope), page.size);
    std::vector<SimulationRecord> simulations;
    while (query.next()) simulations.push_back(listed_simulation_of(query));
    if (!query.status().ok()) return query.status();
    return simulations;
  });
}

absl::Status SqlStore::end_simulation(const SimulationRecord& ended, const SimulationResult& result) {
  const absl::Status kept = turns_.transact([&]() -> absl::Status {
    if (absl::Status owned = fence_.check(ended.id); !owned.ok()) return owned;
    Query update(*database_, "UPDATE simulations SET state = ?, reason = ?, summary = ? WHERE id = ?");
    absl::Status done = update.bind(static_cast<int>(ended.state), ended.reason, ended.summary_message, ended.id).run();
    if (done.ok() && database_->changes() == 0) return no_simulation(ended.id);
    done.Update(write_result(*database_, ended.id, result));
    Query drop(*database_, "DELETE FROM checkpoints WHERE simulation = ? AND kind = ? AND " IS_WHOLE(
                               "checkpoints", CHECKPOINT_COLUMNS));
    done.Update(drop.bind(ended.id, static_cast<int>(CheckpointKind::kAutomatic)).run());
    done.Update(fence_.erase_owner(ended.id));
    return done;
  });
  if (kept.ok()) fence_.forget(ended.id);
  return kept;
}

absl::Status SqlStore::set_simulation_state(const std::string& id, SimulationState state, const std::string& reason) {
  const absl::Status kept = turns_.transact([&]() -> absl::Status {
    if (absl::Status owned = fence_.check(id); !owned.ok()) return owned;
    Query update(*database_, "UPDATE simulations SET state = ?, reason = ? WHERE id = ?");
    const absl::Status done = update.bind(static_cast<int>(state), reason, id).run();
    if (done.ok() && database_->changes() == 0) return no_simulation(id);
    return done.ok() && has_ended(state) ? fence_.erase_owner(id) : done;
  });
  if (kept.ok() && has_ended(state)) fence_.forget(id);
  return kept;
}

absl::Status SqlStore::keep_summary(const std::string& id, const std::string& summary_message) {
  return turns_.transact([&]() -> absl::Status {
    if (absl::Status owned = fence_.check(id); !owned.ok()) return owned;
    Query update(*database_, "UPDATE simulations SET summary = ? WHERE id = ?");
    const absl::Status done = update.bind(summary_message, id).run();
    return done.ok() && database_->changes() == 0 ? no_simulation(id) : done;
  });
}

absl::Status SqlStore::append_series(const std::string& id, const SeriesChunk& chunk) {
  return turns_.transact([&] {
    const absl::Status owned = fence_.check(id);
    return owned.ok() ? write_rows(id, chunk) : owned;
  });
}

absl::Status SqlStore::write_rows(const std::string& simulation, const SeriesChunk& rows) {
  Query insert(*database_, "INSERT INTO simulation_series (" SERIES_COLUMNS ") VALUES (?, ?, ?, ?)");
  return insert.bind(simulation, rows.first_step, rows.last_step, rows.rows_message).run();
}

absl::Status SqlStore::cut_series(const std::string& id, uint64_t last_step) {
  return turns_.transact([&] {
    const absl::Status owned = fence_.check(id);
    return owned.ok() ? erase_rows(id, last_step) : owned;
  });
}

// A chunk ends at every checkpoint, so none lies on both sides of the step.
absl::Status SqlStore::erase_rows(const std::string& simulation, uint64_t last_step) {
  Query remove(*database_, "DELETE FROM simulation_series WHERE simulation = ? AND last_step > ?");
  return remove.bind(simulation, last_step).run();
}

absl::StatusOr<std::optional<SeriesChunk>> SqlStore::next_series_chunk(const std::string& id, uint64_t after_step) {
  return turns_.look([&]() -> absl::StatusOr<std::optional<SeriesChunk>> {
    Query query(*database_, "SELECT first_step, last_step, rows, " IS_WHOLE("simulation_series", SERIES_COLUMNS) " FROM simulation_series WHERE simulation = ? AND last_step > ? "
                            "ORDER BY last_step LIMIT 1");
    if (query.bind(id, after_step).next()) {
      if (!query.is_true(3)) return damaged_record(absl::StrCat(simulation_name(id), " (its series)"));
      return SeriesChunk{query.unsigned_integer(0), query.unsigned_integer(1), query.text(2)};
    }
    if (!query.status().ok()) return query.status();
    return std::nullopt;
  });
}

absl::StatusOr<SimulationResult> SqlStore::get_result(const std::string& id) {
  return turns_.look([&]() -> absl::StatusOr<SimulationResult> {
    const auto simulation = read_simulation(id);
    if (!simulation.ok()) return simulation.status();
    Query query(*database_, "SELECT meshes, frame, " IS_WHOLE(
                                "simulation_results", RESULT_COLUMNS) " FROM simulation_results WHERE simulation = ?");
    if (query.bind(id).next()) {
      if (!query.is_true(2)) return damaged_record(absl::StrCat(simulation_name(id), " (its result)"));
      return SimulationResult{query.text(0), query.text(1)};
    }
    if (!query.status().ok()) return query.status();
    return absl::FailedPreconditionError(absl::StrCat(simulation_name(id), " is ", state_name(simulation->state),
                                                      " and has no result", simulation->reason.empty() ? "" : ": ",
                                                      simulation->reason));
  });
}

absl::Status SqlStore::delete_simulation(const std::string& id) {
  const absl::Status done = turns_.transact([&]() -> absl::Status {
    if (absl::Status owned = fence_.check(id, Unowned::kMayBeWritten); !owned.ok()) return owned;
    Query remove(*database_, "DELETE FROM simulations WHERE id = ?");
    const absl::Status removed = remove.bind(id).run();
    if (removed.ok() && database_->changes() == 0) return no_simulation(id);
    owners_.erase(id);
    return removed.ok() ? forget_requests(simulation_name(id)) : removed;
  });
  if (done.ok()) fence_.forget(id);
  return done;
}

absl::StatusOr<std::vector<SimulationRecord>> SqlStore::list_unended_simulations() {
  return turns_.look([&]() -> absl::StatusOr<std::vector<SimulationRecord>> {
    Query query(*database_, "SELECT " RECORD_COLUMNS ", " LAST_COMMAND ", " SIMULATION_IS_WHOLE
                            " FROM simulations WHERE state < ? ORDER BY id");
    query.bind(static_cast<int>(SimulationState::kSettled));
    std::vector<SimulationRecord> simulations;
    while (query.next()) simulations.push_back(listed_simulation_of(query));
    if (!query.status().ok()) return query.status();
    return simulations;
  });
}

absl::StatusOr<uint64_t> SqlStore::begin_epoch(const std::string& id, int64_t now_us) {
  return turns_.transact([&]() -> absl::StatusOr<uint64_t> {
    if (absl::Status owned = fence_.check(id); !owned.ok()) return owned;
    Query query(*database_, "SELECT epoch, create_time_us FROM simulations WHERE id = ?");
    if (!query.bind(id).next()) return query.status().ok() ? no_simulation(id) : query.status();
    // The first epoch is the time at which the simulation was made.
    const int64_t epoch = std::max({query.integer(0) + 1, query.integer(1) + 1, now_us});
    Query update(*database_, "UPDATE simulations SET epoch = ? WHERE id = ?");
    if (absl::Status done = update.bind(epoch, id).run(); !done.ok()) return done;
    return static_cast<uint64_t>(epoch);
  });
}

absl::Status SqlStore::check_unused(const std::string& first_model, const std::string& last_model) {
  Query query(*database_,
              "SELECT id, state, model FROM simulations WHERE model >= ? AND model < ? AND state < ? LIMIT 1");
  query.bind(first_model, last_model, static_cast<int>(SimulationState::kSettled));
  if (!query.next()) return query.status();
  return absl::FailedPreconditionError(absl::StrCat(simulation_name(query.text(0)), " on ", query.text(2), " is ",
                                                    state_name(static_cast<SimulationState>(query.integer(1))),
                                                    "; stop or delete it first"));
}

}  // namespace lipofill::server
