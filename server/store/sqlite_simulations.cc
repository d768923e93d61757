#include "absl/strings/str_cat.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/store/scope_query.h"
#include "server/store/sqlite_store.h"

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

}  // namespace

absl::StatusOr<SimulationRecord> SqliteStore::create_simulation(const SimulationRecord& simulation,
                                                                const RequestKey& request) {
  return make_simulation(simulation, nullptr, request);
}

absl::StatusOr<SimulationRecord> SqliteStore::create_simulation_from(const SimulationRecord& simulation,
                                                                     const CheckpointRecord& origin,
                                                                     const RequestKey& request) {
  return make_simulation(simulation, &origin, request);
}

absl::StatusOr<SimulationRecord> SqliteStore::make_simulation(const SimulationRecord& simulation,
                                                              const CheckpointRecord* origin,
                                                              const RequestKey& request) {
  const auto earlier = transact_once(request, simulation_name(simulation.id), [&] {
    const absl::Status written = write_simulation(simulation);
    return written.ok() && origin != nullptr ? write_checkpoint(*origin) : written;
  });
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return get_simulation((**earlier).substr(simulation_name("").size()));
  return simulation;
}

absl::Status SqliteStore::write_simulation(const SimulationRecord& simulation) {
  Query insert(*database_, "INSERT INTO simulations (" RECORD_COLUMNS ") VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  const absl::Status done = insert
                                .bind(simulation.id, simulation.model, simulation.display_name, simulation.spec_message,
                                      static_cast<int>(simulation.state), simulation.reason, simulation.summary_message,
                                      simulation.create_time_us, simulation.origin, simulation.tenant)
                                .run();
  if (!absl::IsAlreadyExists(done)) return done;
  return absl::AlreadyExistsError(absl::StrCat(simulation_name(simulation.id), " exists"));
}

absl::StatusOr<SimulationRecord> SqliteStore::get_simulation(const std::string& id) {
  const std::lock_guard lock(mutex_);
  return read_simulation(id);
}

absl::StatusOr<SimulationRecord> SqliteStore::read_simulation(const std::string& id) {
  Query query(*database_,
              "SELECT " RECORD_COLUMNS ", " LAST_COMMAND ", " SIMULATION_IS_WHOLE " FROM simulations WHERE id = ?");
  if (!query.bind(id).next()) return query.status().ok() ? no_simulation(id) : query.status();
  if (!query.is_true(11)) return damaged_record(simulation_name(id));
  return simulation_of(query);
}

absl::StatusOr<Owner> SqliteStore::owner_of_simulation(const std::string& id) {
  const std::lock_guard lock(mutex_);
  if (const auto known = owners_.find(id); known != owners_.end()) return known->second;
  Query query(*database_, "SELECT tenant, " PATIENT_OF_MODEL ", " SIMULATION_IS_WHOLE " FROM simulations WHERE id = ?");
  if (!query.bind(id).next()) return query.status().ok() ? no_simulation(id) : query.status();
  if (!query.is_true(2)) return damaged_record(simulation_name(id));
  return owners_[id] = Owner{query.text(0), query.text(1)};
}

absl::StatusOr<std::vector<SimulationRecord>> SqliteStore::list_simulations(const Scope& scope, const Page& page) {
  const std::lock_guard lock(mutex_);
  Query query(*database_, "SELECT " RECORD_COLUMNS ", " LAST_COMMAND ", " SIMULATION_IS_WHOLE
                          " FROM simulations WHERE tenant = ?1 AND id > ?2 AND (?3 OR " PATIENT_OF_MODEL
                          " IN (SELECT CAST(value AS BLOB) FROM json_each(CAST(?4 AS TEXT)))) ORDER BY id LIMIT ?5");
  query.bind(scope.tenant, page.after, !scope.patients, json_of(scope), page.size);
  std::vector<SimulationRecord> simulations;
  while (query.next()) simulations.push_back(listed_simulation_of(query));
  if (!query.status().ok()) return query.status();
  return simulations;
}

absl::Status SqliteStore::end_simulation(const SimulationRecord& ended, const SimulationResult& result) {
  return transact([&]() -> absl::Status {
    Query update(*database_, "UPDATE simulations SET state = ?, reason = ?, summary = ? WHERE id = ?");
    absl::Status done = update.bind(static_cast<int>(ended.state), ended.reason, ended.summary_message, ended.id).run();
    if (done.ok() && database_->changes() == 0) return no_simulation(ended.id);
    // It is summed here, not by the trigger, which would write these megabytes twice.
    Query insert(
        *database_,
        "INSERT OR REPLACE INTO simulation_results VALUES (?1, ?2, ?3, row_sum('simulation_results', ?1, ?2, ?3))");
    done.Update(insert.bind(ended.id, result.meshes_message, result.frame_message).run());
    Query drop(*database_, "DELETE FROM checkpoints WHERE simulation = ? AND kind = ? AND " IS_WHOLE(
                               "checkpoints", CHECKPOINT_COLUMNS));
    done.Update(drop.bind(ended.id, static_cast<int>(CheckpointKind::kAutomatic)).run());
    return done;
  });
}

absl::Status SqliteStore::set_simulation_state(const std::string& id, SimulationState state,
                                               const std::string& reason) {
  const std::lock_guard lock(mutex_);
  Query update(*database_, "UPDATE simulations SET state = ?, reason = ? WHERE id = ?");
  const absl::Status done = update.bind(static_cast<int>(state), reason, id).run();
  return done.ok() && database_->changes() == 0 ? no_simulation(id) : done;
}

absl::Status SqliteStore::keep_summary(const std::string& id, const std::string& summary_message) {
  const std::lock_guard lock(mutex_);
  Query update(*database_, "UPDATE simulations SET summary = ? WHERE id = ?");
  const absl::Status done = update.bind(summary_message, id).run();
  return done.ok() && database_->changes() == 0 ? no_simulation(id) : done;
}

absl::Status SqliteStore::append_series(const std::string& id, const SeriesChunk& chunk) {
  const std::lock_guard lock(mutex_);
  return write_rows(id, chunk);
}

absl::Status SqliteStore::write_rows(const std::string& simulation, const SeriesChunk& rows) {
  Query insert(*database_, "INSERT INTO simulation_series (" SERIES_COLUMNS ") VALUES (?, ?, ?, ?)");
  return insert.bind(simulation, rows.first_step, rows.last_step, rows.rows_message).run();
}

absl::Status SqliteStore::cut_series(const std::string& id, uint64_t last_step) {
  const std::lock_guard lock(mutex_);
  return erase_rows(id, last_step);
}

// A chunk ends at every checkpoint, so none lies on both sides of the step.
absl::Status SqliteStore::erase_rows(const std::string& simulation, uint64_t last_step) {
  Query remove(*database_, "DELETE FROM simulation_series WHERE simulation = ? AND last_step > ?");
  return remove.bind(simulation, last_step).run();
}

absl::StatusOr<std::optional<SeriesChunk>> SqliteStore::next_series_chunk(const std::string& id, uint64_t after_step) {
  const std::lock_guard lock(mutex_);
  Query query(*database_,
              "SELECT first_step, last_step, rows, " IS_WHOLE("simulation_series", SERIES_COLUMNS) " FROM simulation_series WHERE simulation = ? AND last_step > ? "
              "ORDER BY last_step LIMIT 1");
  if (query.bind(id, after_step).next()) {
    if (!query.is_true(3)) return damaged_record(absl::StrCat(simulation_name(id), " (its series)"));
    return SeriesChunk{query.unsigned_integer(0), query.unsigned_integer(1), query.text(2)};
  }
  if (!query.status().ok()) return query.status();
  return std::nullopt;
}

absl::StatusOr<SimulationResult> SqliteStore::get_result(const std::string& id) {
  const std::lock_guard lock(mutex_);
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
}

absl::Status SqliteStore::delete_simulation(const std::string& id) {
  return transact([&]() -> absl::Status {
    Query remove(*database_, "DELETE FROM simulations WHERE id = ?");
    const absl::Status removed = remove.bind(id).run();
    if (removed.ok() && database_->changes() == 0) return no_simulation(id);
    owners_.erase(id);
    return removed.ok() ? forget_requests(simulation_name(id)) : removed;
  });
}

absl::StatusOr<std::vector<SimulationRecord>> SqliteStore::list_unended_simulations() {
  const std::lock_guard lock(mutex_);
  Query query(*database_, "SELECT " RECORD_COLUMNS ", " LAST_COMMAND ", " SIMULATION_IS_WHOLE
                          " FROM simulations WHERE state < ? ORDER BY id");
  query.bind(static_cast<int>(SimulationState::kSettled));
  std::vector<SimulationRecord> simulations;
  while (query.next()) simulations.push_back(listed_simulation_of(query));
  if (!query.status().ok()) return query.status();
  return simulations;
}

absl::StatusOr<uint64_t> SqliteStore::begin_epoch(const std::string& id, int64_t now_us) {
  const std::lock_guard lock(mutex_);
  // The first epoch is the time at which the simulation was made.
  Query update(*database_,
               "UPDATE simulations SET epoch = max(epoch + 1, create_time_us + 1, ?) WHERE id = ? RETURNING epoch");
  update.bind(now_us, id);
  const bool known = update.next();
  const uint64_t epoch = known ? update.unsigned_integer(0) : 0;
  if (auto done = update.run(); !done.ok()) return done;
  return known ? absl::StatusOr<uint64_t>(epoch) : no_simulation(id);
}

absl::Status SqliteStore::check_unused(const std::string& first_model, const std::string& last_model) {
  Query query(*database_,
              "SELECT id, state, model FROM simulations WHERE model >= ? AND model < ? AND state < ? LIMIT 1");
  query.bind(first_model, last_model, static_cast<int>(SimulationState::kSettled));
  if (!query.next()) return query.status();
  return absl::FailedPreconditionError(absl::StrCat(simulation_name(query.text(0)), " on ", query.text(2), " is ",
                                                    state_name(static_cast<SimulationState>(query.integer(1))),
                                                    "; stop or delete it first"));
}

}  // namespace lipofill::server
