#include "server/store/sql_store.h"

namespace lipofill::server {

absl::Status SqlStore::note_draft(const std::string& path) {
  return turns_.transact([&] {
    Query insert(*database_, "INSERT INTO temporary_files VALUES (?, 1) ON CONFLICT (path) DO UPDATE SET is_draft = 1");
    return insert.bind(path).run();
  });
}

absl::StatusOr<std::vector<TemporaryFile>> SqlStore::list_temporary_files() {
  return turns_.look([&]() -> absl::StatusOr<std::vector<TemporaryFile>> {
    Query query(*database_, "SELECT path, is_draft FROM temporary_files ORDER BY path");
    std::vector<TemporaryFile> files;
    while (query.next()) files.push_back({query.text(0), query.is_true(1)});
    if (!query.status().ok()) return query.status();
    return files;
  });
}

absl::Status SqlStore::forget_temporary_files(const std::vector<std::string>& paths) {
  if (paths.empty()) return absl::OkStatus();
  return turns_.transact([&] {
    absl::Status done;
    for (const std::string& path : paths) {
      Query remove(*database_, "DELETE FROM temporary_files WHERE path = ?");
      done.Update(remove.bind(path).run());
    }
    return done;
  });
}

absl::StatusOr<StoreIdentity> SqlStore::read_identity() {
  return turns_.look([&]() -> absl::StatusOr<StoreIdentity> {
    Query query(*database_, "SELECT id, starts FROM store");
    if (query.next()) return StoreIdentity{query.text(0), query.unsigned_integer(1)};
    return query.status().ok() ? absl::DataLossError("the database does not say which store it is") : query.status();
  });
}

absl::Status SqlStore::set_starts(uint64_t starts) {
  return turns_.transact([&] {
    Query update(*database_, "UPDATE store SET starts = ?");
    return update.bind(starts).run();
  });
}

}  // namespace lipofill::server
