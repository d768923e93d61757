#include "server/store/sqlite_store.h"

#include "absl/strings/str_cat.h"
#include "server/store/row_sums.h"
#include "server/store/schema.h"

namespace lipofill::server {

absl::StatusOr<std::unique_ptr<SqliteStore>> SqliteStore::open(const std::string& path) {
  auto database = Database::open(path);
  if (!database.ok()) return database.status();
  if (auto whole = check_database(**database, path); !whole.ok()) return whole;
  if (auto ready = bring_up_to_date(**database, path); !ready.ok()) return ready;
  // FULL: what was acknowledged survives a loss of power too, not only the end of the process.
  constexpr char kSettings[] =
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON; PRAGMA trusted_schema = OFF";
  if (auto set = (*database)->execute(kSettings); !set.ok()) return set;
  return std::unique_ptr<SqliteStore>(new SqliteStore(*std::move(database)));
}

absl::StatusOr<std::optional<std::string>> SqliteStore::find_request(const RequestKey& request) {
  const std::lock_guard lock(mutex_);
  return read_request(request);
}

absl::Status SqliteStore::transact(const Work& work) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(*database_);
  if (!transaction.status().ok()) return transaction.status();
  const absl::Status done = work();
  return done.ok() ? transaction.commit() : done;
}

absl::StatusOr<std::optional<std::string>> SqliteStore::transact_once(const RequestKey& request,
                                                                      const std::string& name, const Work& work) {
  std::optional<std::string> earlier;
  const absl::Status done = transact([&]() -> absl::Status {
    auto made = read_request(request);
    if (!made.ok()) return made.status();
    earlier = *std::move(made);
    if (earlier.has_value()) return absl::OkStatus();
    const absl::Status worked = work();
    return worked.ok() ? write_request(request, name) : worked;
  });
  if (!done.ok()) return done;
  return earlier;
}

absl::StatusOr<std::optional<std::string>> SqliteStore::read_request(const RequestKey& request) {
  if (request.id.empty()) return std::nullopt;
  Query query(*database_, "SELECT fingerprint, name, " IS_WHOLE(
                              "requests", REQUEST_COLUMNS) " FROM requests WHERE tenant = ? AND method = ? AND id = ?");
  query.bind(request.tenant, request.method, request.id);
  if (!query.next()) {
    if (!query.status().ok()) return query.status();
    return std::nullopt;
  }
  if (!query.is_true(2)) return damaged_record(absl::StrCat("the request ", request.id));
  if (query.text(0) != request.fingerprint) {
    return absl::InvalidArgumentError(
        absl::StrCat("request_id ", request.id, " was used for another ", request.method, " request"));
  }
  return query.text(1);
}

absl::Status SqliteStore::write_request(const RequestKey& request, const std::string& name) {
  if (request.id.empty()) return absl::OkStatus();
  Query query(*database_, "INSERT INTO requests (" REQUEST_COLUMNS ") VALUES (?, ?, ?, ?, ?)");
  return query.bind(request.tenant, request.method, request.id, request.fingerprint, name).run();
}

absl::Status SqliteStore::forget_requests(const std::string& name) {
  Query query(*database_, "DELETE FROM requests WHERE name = ? OR (name >= ? AND name < ?)");
  return query.bind(name, name + "/", name + "0").run();  // '0' follows '/'
}

}  // namespace lipofill::server
