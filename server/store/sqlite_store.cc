#include "server/store/sqlite_store.h"

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

constexpr int kSchemaVersion = 2;
constexpr int kApplicationId = 0x4c69706f;  // "Lipo"

/// Ids are compared as bytes; requests hold the full name of what they made.
constexpr char kSchema[] = R"(
CREATE TABLE patients (
  id BLOB PRIMARY KEY, display_name BLOB NOT NULL, create_time_us INTEGER NOT NULL) WITHOUT ROWID;
CREATE TABLE patient_labels (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, key BLOB NOT NULL, value BLOB NOT NULL,
  PRIMARY KEY (patient, key)) WITHOUT ROWID;
CREATE TABLE scans (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, id BLOB NOT NULL, format INTEGER NOT NULL,
  unit INTEGER NOT NULL, size_bytes INTEGER NOT NULL, sha256 BLOB NOT NULL, received_bytes INTEGER NOT NULL,
  complete INTEGER NOT NULL, report BLOB NOT NULL, create_time_us INTEGER NOT NULL, PRIMARY KEY (patient, id));
CREATE TABLE models (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, id BLOB NOT NULL, scan BLOB NOT NULL,
  content_hash BLOB NOT NULL, spec BLOB NOT NULL, report BLOB NOT NULL, create_time_us INTEGER NOT NULL,
  bone_scan BLOB NOT NULL DEFAULT x'', PRIMARY KEY (patient, id));
CREATE TABLE simulations (
  id BLOB PRIMARY KEY, model BLOB NOT NULL, display_name BLOB NOT NULL, spec BLOB NOT NULL, state INTEGER NOT NULL,
  reason BLOB NOT NULL, summary BLOB NOT NULL, create_time_us INTEGER NOT NULL);
CREATE TABLE simulation_results (
  simulation BLOB PRIMARY KEY REFERENCES simulations(id) ON DELETE CASCADE, meshes BLOB NOT NULL, frame BLOB NOT NULL);
CREATE TABLE simulation_series (
  simulation BLOB NOT NULL REFERENCES simulations(id) ON DELETE CASCADE, first_step INTEGER NOT NULL,
  last_step INTEGER NOT NULL, rows BLOB NOT NULL, PRIMARY KEY (simulation, last_step));
CREATE TABLE requests (
  method BLOB NOT NULL, id BLOB NOT NULL, fingerprint BLOB NOT NULL, name BLOB NOT NULL,
  PRIMARY KEY (method, id)) WITHOUT ROWID;
CREATE INDEX requests_by_name ON requests(name);
)";

/// What a database of schema version 1 lacks.
constexpr char kFromVersion1[] = "ALTER TABLE models ADD COLUMN bone_scan BLOB NOT NULL DEFAULT x''";

absl::StatusOr<int64_t> read_pragma(Database& database, const char* sql) {
  Query query(database, sql);
  const int64_t value = query.next() ? query.integer(0) : 0;
  if (!query.status().ok()) return query.status();
  return value;
}

/// Changes the schema and marks the database as of this version, or does neither.
absl::Status change_schema(Database& database, const char* statements) {
  Transaction transaction(database);
  if (!transaction.status().ok()) return transaction.status();
  if (auto made = database.execute(statements); !made.ok()) return made;
  const std::string marks =
      absl::StrCat("PRAGMA application_id = ", kApplicationId, "; PRAGMA user_version = ", kSchemaVersion);
  if (auto marked = database.execute(marks.c_str()); !marked.ok()) return marked;
  return transaction.commit();
}

absl::Status bring_up_to_date(Database& database, const std::string& path) {
  const auto version = read_pragma(database, "PRAGMA user_version");
  if (!version.ok()) return absl::Status(version.status().code(), absl::StrCat(path, ": ", version.status().message()));
  const auto tables = read_pragma(database, "SELECT count(*) FROM sqlite_master");
  if (!tables.ok()) return tables.status();
  if (*version == 0 && *tables == 0) return change_schema(database, kSchema);
  const auto application = read_pragma(database, "PRAGMA application_id");
  if (!application.ok()) return application.status();
  if (*application != kApplicationId) {
    return absl::FailedPreconditionError(absl::StrCat(path, " is a database of another program"));
  }
  if (*version == 1) return change_schema(database, kFromVersion1);
  if (*version != kSchemaVersion) {
    return absl::FailedPreconditionError(
        absl::StrCat(path, " has schema version ", *version, ", this program knows ", kSchemaVersion));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteStore>> SqliteStore::open(const std::string& path) {
  auto database = Database::open(path);
  if (!database.ok()) return database.status();
  if (auto ready = bring_up_to_date(**database, path); !ready.ok()) return ready;
  constexpr char kSettings[] =
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA foreign_keys = ON; PRAGMA trusted_schema = OFF";
  if (auto set = (*database)->execute(kSettings); !set.ok()) return set;
  return std::unique_ptr<SqliteStore>(new SqliteStore(*std::move(database)));
}

absl::StatusOr<std::optional<std::string>> SqliteStore::find_request(const RequestKey& request) {
  const std::lock_guard lock(mutex_);
  return read_request(request);
}

absl::StatusOr<std::optional<std::string>> SqliteStore::read_request(const RequestKey& request) {
  if (request.id.empty()) return std::nullopt;
  Query query(*database_, "SELECT fingerprint, name FROM requests WHERE method = ? AND id = ?");
  query.bind(request.method, request.id);
  if (!query.next()) {
    if (!query.status().ok()) return query.status();
    return std::nullopt;
  }
  if (query.text(0) != request.fingerprint) {
    return absl::InvalidArgumentError(
        absl::StrCat("request_id ", request.id, " was used for another ", request.method, " request"));
  }
  return query.text(1);
}

absl::Status SqliteStore::write_request(const RequestKey& request, const std::string& name) {
  if (request.id.empty()) return absl::OkStatus();
  Query query(*database_, "INSERT INTO requests VALUES (?, ?, ?, ?)");
  return query.bind(request.method, request.id, request.fingerprint, name).run();
}

absl::Status SqliteStore::forget_requests(const std::string& name) {
  Query query(*database_, "DELETE FROM requests WHERE name = ? OR (name >= ? AND name < ?)");
  return query.bind(name, name + "/", name + "0").run();  // '0' follows '/'
}

std::string patient_name(const std::string& patient) {
  return absl::StrCat("patients/", patient);
}
std::string scan_name(const std::string& patient, const std::string& scan) {
  return absl::StrCat("patients/", patient, "/scans/", scan);
}
std::string model_name(const std::string& patient, const std::string& model) {
  return absl::StrCat("patients/", patient, "/models/", model);
}
std::string simulation_name(const std::string& simulation) {
  return absl::StrCat("simulations/", simulation);
}

}  // namespace lipofill::server
