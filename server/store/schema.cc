#include "server/store/schema.h"

#include <cstdint>

#include "absl/status/statusor.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/store/row_sums.h"
#include "server/store/schema_tables.h"

namespace lipofill::server {
namespace {

constexpr int kApplicationId = 0x4c69706f;  // "Lipo"

/// 2: the bone under a face.
constexpr char kFromVersion1[] = "ALTER TABLE models ADD COLUMN bone_scan BLOB NOT NULL DEFAULT x'';";

/// 3: commands are logged and simulations have checkpoints, in kResumeTables. What was under way
/// under version 2 was lost with its daemon.
constexpr char kFromVersion2[] = R"(
ALTER TABLE simulations ADD COLUMN epoch INTEGER NOT NULL DEFAULT 0;
ALTER TABLE simulations ADD COLUMN origin BLOB NOT NULL DEFAULT x'';
UPDATE simulations SET state = 7, reason = CAST('the daemon stopped' AS BLOB) WHERE state < 4;
)";

/// 4: patients, simulations and requests belong to a tenant. What there was belongs to "local".
constexpr char kFromVersion3[] = R"(
ALTER TABLE patients ADD COLUMN tenant BLOB NOT NULL DEFAULT x'6c6f63616c';
ALTER TABLE simulations ADD COLUMN tenant BLOB NOT NULL DEFAULT x'6c6f63616c';
CREATE TABLE requests_of_tenants (
  tenant BLOB NOT NULL, method BLOB NOT NULL, id BLOB NOT NULL, fingerprint BLOB NOT NULL, name BLOB NOT NULL,
  PRIMARY KEY (tenant, method, id)) WITHOUT ROWID;
INSERT INTO requests_of_tenants SELECT x'6c6f63616c', method, id, fingerprint, name FROM requests;
DROP TABLE requests;
ALTER TABLE requests_of_tenants RENAME TO requests;
CREATE INDEX requests_by_name ON requests(name);
)";

/// 5: the store has an id; rows have sums (make_row_sums()); files that may be removed are
/// recorded, in kStoreTables: those being written, of which there is no record yet, and those whose
/// record was deleted.
constexpr char kFromVersion4[] = R"(
INSERT INTO store SELECT CAST(lower(hex(randomblob(16))) AS BLOB), 0;
CREATE TRIGGER files_of_scans AFTER DELETE ON scans BEGIN
  INSERT OR REPLACE INTO temporary_files
    VALUES (CAST('scans/' || CAST(OLD.patient AS TEXT) || '/' || CAST(OLD.id AS TEXT) AS BLOB), 0); END;
CREATE TRIGGER files_of_checkpoints AFTER DELETE ON checkpoints BEGIN
  INSERT OR REPLACE INTO temporary_files
    VALUES (CAST('checkpoints/' || CAST(OLD.simulation AS TEXT) || '/' || CAST(OLD.id AS TEXT) AS BLOB), 0); END;
CREATE TRIGGER recorded_checkpoints AFTER INSERT ON checkpoints BEGIN
  DELETE FROM temporary_files
    WHERE path = CAST('checkpoints/' || CAST(NEW.simulation AS TEXT) || '/' || CAST(NEW.id AS TEXT) AS BLOB); END;
)";

absl::StatusOr<int64_t> read_pragma(Database& database, const char* sql) {
  Query query(database, sql);
  const int64_t value = query.next() ? query.integer(0) : 0;
  if (!query.status().ok()) return query.status();
  return value;
}

/// Carries out the statements and marks the database as of this version, or does neither.
absl::Status change_schema(Database& database, const std::string& statements) {
  Transaction transaction(database);
  if (!transaction.status().ok()) return transaction.status();
  if (auto made = database.execute(statements.c_str()); !made.ok()) return made;
  const std::string marks =
      absl::StrCat("PRAGMA application_id = ", kApplicationId, "; PRAGMA user_version = ", kSchemaVersion);
  if (auto marked = database.execute(marks.c_str()); !marked.ok()) return marked;
  return transaction.commit();
}

absl::Status damaged(const std::string& path, const std::string& what) {
  return absl::DataLossError(
      absl::StrCat(path, " is damaged: ", what,
                   ". Put a backup in its place; or take out what can be read with sqlite3's .recover into a new file "
                   "and put that in its place; or move it away to begin with an empty store"));
}

/// Labels have no index beside their table: one whose patient rotted is found by nobody.
absl::Status check_labels(Database& database, const std::string& path) {
  Query stray(database, "PRAGMA foreign_key_check(patient_labels)");
  if (stray.next()) return damaged(path, "a label is of no patient");
  return stray.status();
}

/// The schema is rows of a table too, which may rot: statements must understand it, and the
/// triggers must be those that were made.
absl::Status check_schema(Database& database, const std::string& path) {
  for (const SummedTable& table : kSummedTables) {
    Query columns(database, absl::StrCat("SELECT ", table.columns, ", sum FROM ", table.name, " LIMIT 0").c_str());
    if (!columns.run().ok()) return damaged(path, std::string(columns.status().message()));
  }
  const std::string expected = absl::StrCat(kFromVersion4, make_row_sums(0));
  Query triggers(database, "SELECT name, sql FROM sqlite_master WHERE type = 'trigger'");
  size_t n = 0;
  for (; triggers.next(); ++n) {
    if (!absl::StrContains(expected, triggers.text(1))) {
      return damaged(path, absl::StrCat("the trigger ", triggers.text(0), " is not what was made"));
    }
  }
  if (!triggers.status().ok()) return triggers.status();
  constexpr size_t kTriggersOfFiles = 3;
  constexpr size_t kTriggersOfSums = 3;
  const size_t n_made = kTriggersOfFiles + kTriggersOfSums * kSummedTables.size();
  if (n != n_made) return damaged(path, absl::StrCat("it has ", n, " triggers, ", n_made, " were made"));
  return check_labels(database, path);
}

/// "ok", or the first thing that does not fit.
absl::StatusOr<std::string> check_integrity(Database& database, const std::string& path) {
  Query check(database, "PRAGMA integrity_check(1)");
  const std::string found = check.next() ? check.text(0) : "";
  if (absl::IsDataLoss(check.status())) return damaged(path, std::string(check.status().message()));
  if (!check.status().ok()) {
    return absl::Status(check.status().code(), absl::StrCat(path, ": ", check.status().message()));
  }
  return found;
}

}  // namespace

absl::Status check_database(Database& database, const std::string& path) {
  auto found = check_integrity(database, path);
  if (!found.ok() || *found == "ok") return found.status();
  // Indexes can be made again from their tables, whose rows have sums.
  if (database.execute("REINDEX").ok()) found = check_integrity(database, path);
  if (!found.ok()) return found.status();
  return *found == "ok" ? absl::OkStatus() : damaged(path, *found);
}

absl::Status bring_up_to_date(Database& database, const std::string& path) {
  const auto version = read_pragma(database, "PRAGMA user_version");
  if (!version.ok()) return version.status();
  const auto tables = read_pragma(database, "SELECT count(*) FROM sqlite_master");
  if (!tables.ok()) return tables.status();
  if (*version == 0 && *tables == 0)
    return change_schema(database, absl::StrCat(kSchema, kResumeTables, kTenantIndexes, kStoreTables, kFromVersion4,
                                                kPlanTables, kOperationTables, make_row_sums(0)));
  const auto application = read_pragma(database, "PRAGMA application_id");
  if (!application.ok()) return application.status();
  if (*application != kApplicationId) {
    return absl::FailedPreconditionError(absl::StrCat(path, " is a database of another program"));
  }
  if (*version < 1 || *version > kSchemaVersion) {
    return absl::FailedPreconditionError(
        absl::StrCat(path, " has schema version ", *version, ", this program knows 1 to ", kSchemaVersion));
  }
  std::string changes;
  if (*version < 2) changes += kFromVersion1;
  if (*version < 3) absl::StrAppend(&changes, kFromVersion2, kResumeTables);
  if (*version < 4) absl::StrAppend(&changes, kFromVersion3, kTenantIndexes);
  if (*version < 5) absl::StrAppend(&changes, kStoreTables, kFromVersion4);
  if (*version < 6) absl::StrAppend(&changes, kPlanTables);
  if (*version < 7) absl::StrAppend(&changes, kOperationTables, make_row_sums(static_cast<int>(*version)));
  if (changes.empty()) return check_schema(database, path);
  return change_schema(database, changes);
}

}  // namespace lipofill::server
