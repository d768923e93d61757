#include "absl/strings/str_cat.h"
#include "server/store/record_names.h"
#include "server/store/sqlite_store.h"

namespace lipofill::server {
namespace {

#define CHECKPOINT_COLUMNS                                                                                \
  "simulation, id, kind, on_course, step, time_s, wall_s, last_command, size_bytes, sha256, state_hash, " \
  "create_time_us"

CheckpointRecord checkpoint_of(const Query& row) {
  CheckpointRecord checkpoint;
  checkpoint.simulation = row.text(0);
  checkpoint.id = row.text(1);
  checkpoint.kind = static_cast<CheckpointKind>(row.integer(2));
  checkpoint.on_course = row.integer(3) != 0;
  checkpoint.step = row.unsigned_integer(4);
  checkpoint.time_s = row.real(5);
  checkpoint.wall_s = row.real(6);
  checkpoint.last_command = row.unsigned_integer(7);
  checkpoint.size_bytes = row.unsigned_integer(8);
  checkpoint.sha256 = row.text(9);
  checkpoint.state_hash = row.text(10);
  checkpoint.create_time_us = row.integer(11);
  return checkpoint;
}

}  // namespace

absl::StatusOr<CheckpointRecord> SqliteStore::create_checkpoint(const CheckpointRecord& checkpoint,
                                                                const std::optional<SeriesChunk>& rows,
                                                                const RequestKey& request) {
  absl::StatusOr<CheckpointRecord> kept = absl::UnknownError("");
  const absl::Status done = transact([&]() -> absl::Status {
    if (const auto simulation = read_simulation(checkpoint.simulation); !simulation.ok()) return simulation.status();
    absl::Status written = write_checkpoint(checkpoint);
    if (rows.has_value()) written.Update(write_rows(checkpoint.simulation, *rows));
    written.Update(write_request(request, checkpoint_name(checkpoint.simulation, checkpoint.id)));
    if (!written.ok()) return written;
    kept = read_checkpoint(checkpoint.simulation, checkpoint.id);
    return kept.status();
  });
  return done.ok() ? kept : done;
}

absl::Status SqliteStore::write_checkpoint(const CheckpointRecord& checkpoint) {
  Query insert(*database_, "INSERT INTO checkpoints (" CHECKPOINT_COLUMNS
                           ") SELECT ?1, ?2, ?3, 1, ?4, ?5, ?6, coalesce(max(number), 0), ?7, ?8, ?9, ?10 "
                           "FROM simulation_commands WHERE simulation = ?1");
  const absl::Status done = insert
                                .bind(checkpoint.simulation, checkpoint.id, static_cast<int>(checkpoint.kind),
                                      checkpoint.step, checkpoint.time_s, checkpoint.wall_s, checkpoint.size_bytes,
                                      checkpoint.sha256, checkpoint.state_hash, checkpoint.create_time_us)
                                .run();
  if (!absl::IsAlreadyExists(done)) return done;
  return absl::AlreadyExistsError(absl::StrCat(checkpoint_name(checkpoint.simulation, checkpoint.id), " exists"));
}

absl::StatusOr<CheckpointRecord> SqliteStore::get_checkpoint(const std::string& simulation, const std::string& id) {
  const std::lock_guard lock(mutex_);
  return read_checkpoint(simulation, id);
}

absl::StatusOr<CheckpointRecord> SqliteStore::read_checkpoint(const std::string& simulation, const std::string& id) {
  Query query(*database_, "SELECT " CHECKPOINT_COLUMNS " FROM checkpoints WHERE simulation = ? AND id = ?");
  if (query.bind(simulation, id).next()) return checkpoint_of(query);
  if (!query.status().ok()) return query.status();
  return absl::NotFoundError(absl::StrCat("there is no ", checkpoint_name(simulation, id)));
}

absl::StatusOr<std::vector<CheckpointRecord>> SqliteStore::list_checkpoints(const std::string& simulation,
                                                                            const Page& page) {
  const std::lock_guard lock(mutex_);
  if (const auto known = read_simulation(simulation); !known.ok()) return known.status();
  Query query(*database_,
              "SELECT " CHECKPOINT_COLUMNS " FROM checkpoints WHERE simulation = ? AND id > ? ORDER BY id LIMIT ?");
  query.bind(simulation, page.after, page.size);
  std::vector<CheckpointRecord> checkpoints;
  while (query.next()) checkpoints.push_back(checkpoint_of(query));
  if (!query.status().ok()) return query.status();
  return checkpoints;
}

absl::Status SqliteStore::delete_checkpoint(const std::string& simulation, const std::string& id) {
  return transact([&]() -> absl::Status {
    const auto checkpoint = read_checkpoint(simulation, id);
    if (!checkpoint.ok()) return checkpoint.status();
    const auto owner = read_simulation(simulation);
    if (!owner.ok()) return owner.status();
    if (checkpoint->kind == CheckpointKind::kOrigin && !has_ended(owner->state)) {
      return absl::FailedPreconditionError(absl::StrCat(simulation_name(simulation), " began from ",
                                                        checkpoint_name(simulation, id), " and has not ended"));
    }
    Query remove(*database_, "DELETE FROM checkpoints WHERE simulation = ? AND id = ?");
    const absl::Status removed = remove.bind(simulation, id).run();
    return removed.ok() ? forget_requests(checkpoint_name(simulation, id)) : removed;
  });
}

absl::Status SqliteStore::prune_checkpoints(const std::string& simulation, int newest) {
  const std::lock_guard lock(mutex_);
  Query remove(*database_,
               "DELETE FROM checkpoints WHERE simulation = ?1 AND kind = ?2 AND id NOT IN "
               "(SELECT id FROM checkpoints WHERE simulation = ?1 AND kind = ?2 AND on_course "
               "ORDER BY last_command DESC, step DESC, create_time_us DESC LIMIT ?3)");
  return remove.bind(simulation, static_cast<int>(CheckpointKind::kAutomatic), newest).run();
}

absl::StatusOr<uint64_t> SqliteStore::count_checkpoint_bytes() {
  const std::lock_guard lock(mutex_);
  Query query(*database_, "SELECT coalesce(sum(size_bytes), 0) FROM checkpoints");
  const uint64_t bytes = query.next() ? query.unsigned_integer(0) : 0;
  if (!query.status().ok()) return query.status();
  return bytes;
}

}  // namespace lipofill::server
