#include "server/store/sqlite_store.h"

namespace lipofill::server {

absl::Status SqliteStore::note_draft(const std::string& path) {
  const std::lock_guard lock(mutex_);
  Query insert(*database_, "INSERT OR REPLACE INTO temporary_files VALUES (?, 1)");
  return insert.bind(path).run();
}

absl::StatusOr<std::vector<TemporaryFile>> SqliteStore::list_temporary_files() {
  const std::lock_guard lock(mutex_);
  Query query(*database_, "SELECT path, is_draft FROM temporary_files ORDER BY path");
  std::vector<TemporaryFile> files;
  while (query.next()) files.push_back({query.text(0), query.is_true(1)});
  if (!query.status().ok()) return query.status();
  return files;
}

absl::Status SqliteStore::forget_temporary_files(const std::vector<std::string>& paths) {
  if (paths.empty()) return absl::OkStatus();
  return transact([&] {
    absl::Status done;
    for (const std::string& path : paths) {
      Query remove(*database_, "DELETE FROM temporary_files WHERE path = ?");
      done.Update(remove.bind(path).run());
    }
    return done;
  });
}

absl::StatusOr<StoreIdentity> SqliteStore::read_identity() {
  const std::lock_guard lock(mutex_);
  Query query(*database_, "SELECT id, starts FROM store");
  if (query.next()) return StoreIdentity{query.text(0), query.unsigned_integer(1)};
  return query.status().ok() ? absl::DataLossError("the database does not say which store it is") : query.status();
}

absl::Status SqliteStore::set_starts(uint64_t starts) {
  const std::lock_guard lock(mutex_);
  Query update(*database_, "UPDATE store SET starts = ?");
  return update.bind(starts).run();
}

}  // namespace lipofill::server
