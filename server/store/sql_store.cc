#include "server/store/sql_store.h"

#include "absl/strings/str_cat.h"
#include "server/store/database_opening.h"
#include "server/store/row_sums.h"

namespace lipofill::server {

absl::StatusOr<std::unique_ptr<SqlStore>> SqlStore::open(const std::string& place) {
  auto database = open_database(place);
  if (!database.ok()) return database.status();
  return std::make_unique<SqlStore>(*std::move(database));
}

absl::StatusOr<std::optional<std::string>> SqlStore::find_request(const RequestKey& request) {
  return turns_.look([&] { return read_request(request); });
}

absl::StatusOr<std::optional<std::string>> SqlStore::transact_once(const RequestKey& request, const std::string& name,
                                                                   const std::function<absl::Status()>& work) {
  std::optional<std::string> earlier;
  const absl::Status done = turns_.transact([&]() -> absl::Status {
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

absl::StatusOr<std::optional<std::string>> SqlStore::read_request(const RequestKey& request) {
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

absl::Status SqlStore::write_request(const RequestKey& request, const std::string& name) {
  if (request.id.empty()) return absl::OkStatus();
  Query query(*database_, "INSERT INTO requests (" REQUEST_COLUMNS ") VALUES (?, ?, ?, ?, ?)");
  return query.bind(request.tenant, request.method, request.id, request.fingerprint, name).run();
}

absl::Status SqlStore::forget_requests(const std::string& name) {
  Query query(*database_, "DELETE FROM requests WHERE name = ? OR (name >= ? AND name < ?)");
  return query.bind(name, name + "/", name + "0").run();  // '0' follows '/'
}

}  // namespace lipofill::server
