#include "absl/strings/str_cat.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/store/sql_store.h"

namespace lipofill::server {
namespace {

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

/// A row of a list: one that is damaged is named and no more.
CheckpointRecord listed_checkpoint_of(const Query& row) {
  if (row.is_true(12)) return checkpoint_of(row);
  CheckpointRecord damaged;
  damaged.simulation = row.text(0);
  damaged.id = row.text(1);
  damaged.is_damaged = true;
  return damaged;
}

}  // namespace

absl::StatusOr<CheckpointRecord> SqlStore::create_checkpoint(const CheckpointRecord& checkpoint,
                                                             const std::optional<SeriesChunk>& rows,
                                                             const RequestKey& request) {
  return turns_.transact([&]() -> absl::StatusOr<CheckpointRecord> {
    if (const auto simulation = read_simulation(checkpoint.simulation); !simulation.ok()) return simulation.status();
    if (absl::Status owned = fence_.check(checkpoint.simulation); !owned.ok()) return owned;
    absl::Status written = write_checkpoint(checkpoint);
    if (rows.has_value()) written.Update(write_rows(checkpoint.simulation, *rows));
    written.Update(write_request(request, checkpoint_name(checkpoint.simulation, checkpoint.id)));
    if (!written.ok()) return written;
    return read_checkpoint(checkpoint.simulation, checkpoint.id);
  });
}

absl::Status SqlStore::write_checkpoint(const CheckpointRecord& checkpoint) {
  auto last_command = absl::StatusOr<uint64_t>(checkpoint.last_command);
  if (checkpoint.last_command == 0) last_command = read_last_command(checkpoint.simulation);
  if (!last_command.ok()) return last_command.status();
  Query insert(*database_,
               "INSERT INTO checkpoints (" CHECKPOINT_COLUMNS ") VALUES (?, ?, ?, 1, ?, ?, ?, ?, ?, ?, ?, ?)");
  const absl::Status done =
      insert
          .bind(checkpoint.simulation, checkpoint.id, static_cast<int>(checkpoint.kind), checkpoint.step,
                checkpoint.time_s, checkpoint.wall_s, *last_command, checkpoint.size_bytes, checkpoint.sha256,
                checkpoint.state_hash, checkpoint.create_time_us)
          .run();
  if (!absl::IsAlreadyExists(done)) return done;
  return absl::AlreadyExistsError(absl::StrCat(checkpoint_name(checkpoint.simulation, checkpoint.id), " exists"));
}

absl::StatusOr<CheckpointRecord> SqlStore::get_checkpoint(const std::string& simulation, const std::string& id) {
  return turns_.look([&] { return read_checkpoint(simulation, id); });
}

absl::StatusOr<CheckpointRecord> SqlStore::read_checkpoint(const std::string& simulation, const std::string& id) {
  Query query(*database_, "SELECT " CHECKPOINT_COLUMNS ", " IS_WHOLE(
                              "checkpoints", CHECKPOINT_COLUMNS) " FROM checkpoints WHERE simulation = ? AND id = ?");
  if (!query.bind(simulation, id).next()) {
    if (!query.status().ok()) return query.status();
    return absl::NotFoundError(absl::StrCat("there is no ", checkpoint_name(simulation, id)));
  }
  if (!query.is_true(12)) return damaged_record(checkpoint_name(simulation, id));
  return checkpoint_of(query);
}

absl::StatusOr<std::vector<CheckpointRecord>> SqlStore::list_checkpoints(const std::string& simulation,
                                                                         const Page& page) {
  return turns_.look([&]() -> absl::StatusOr<std::vector<CheckpointRecord>> {
    if (const auto known = read_simulation(simulation); !known.ok()) return known.status();
    Query query(
        *database_,
        "SELECT " CHECKPOINT_COLUMNS ", " IS_WHOLE(
            "checkpoints", CHECKPOINT_COLUMNS) " FROM checkpoints WHERE simulation = ? AND id > ? ORDER BY id LIMIT ?");
    query.bind(simulation, page.after, page.size);
    std::vector<CheckpointRecord> checkpoints;
    while (query.next()) checkpoints.push_back(listed_checkpoint_of(query));
    if (!query.status().ok()) return query.status();
    return checkpoints;
  });
}

absl::Status SqlStore::delete_checkpoint(const std::string& simulation, const std::string& id) {
  return turns_.transact([&]() -> absl::Status {
    if (absl::Status owned = fence_.check(simulation, Unowned::kMayBeWritten); !owned.ok()) return owned;
    // What is damaged can go.
    const auto checkpoint = read_checkpoint(simulation, id);
    if (!checkpoint.ok() && !absl::IsDataLoss(checkpoint.status())) return checkpoint.status();
    const auto owner = read_simulation(simulation);
    if (!owner.ok()) return owner.status();
    if (checkpoint.ok() && checkpoint->kind == CheckpointKind::kOrigin && !has_ended(owner->state)) {
      return absl::FailedPreconditionError(absl::StrCat(simulation_name(simulation), " began from ",
                                                        checkpoint_name(simulation, id), " and has not ended"));
    }
    Query remove(*database_, "DELETE FROM checkpoints WHERE simulation = ? AND id = ?");
    const absl::Status removed = remove.bind(simulation, id).run();
    return removed.ok() ? forget_requests(checkpoint_name(simulation, id)) : removed;
  });
}

absl::Status SqlStore::prune_checkpoints(const std::string& simulation, int newest) {
  return turns_.transact([&]() -> absl::Status {
    if (absl::Status owned = fence_.check(simulation); !owned.ok()) return owned;
    Query remove(*database_,
                 "DELETE FROM checkpoints WHERE simulation = ?1 AND kind = ?2 AND " IS_WHOLE(
                     "checkpoints", CHECKPOINT_COLUMNS) " AND id NOT IN "
                 "(SELECT id FROM checkpoints WHERE simulation = ?1 AND kind = ?2 AND on_course = 1 "
                 "ORDER BY last_command DESC, step DESC, create_time_us DESC LIMIT ?3)");
    return remove.bind(simulation, static_cast<int>(CheckpointKind::kAutomatic), newest).run();
  });
}

absl::StatusOr<uint64_t> SqlStore::count_checkpoint_bytes() {
  return turns_.look([&]() -> absl::StatusOr<uint64_t> {
    Query query(*database_, "SELECT coalesce(sum(size_bytes), 0) FROM checkpoints");
    const uint64_t bytes = query.next() ? query.unsigned_integer(0) : 0;
    if (!query.status().ok()) return query.status();
    return bytes;
  });
}

}  // namespace lipofill::server
