#include "server/store/verification.h"

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "server/store/kept_files.h"
#include "server/store/row_sums.h"

namespace lipofill::server {
namespace fs = std::filesystem;
namespace {

constexpr char kDatabase[] = "lipofill.sqlite";
constexpr int kFirstVersionWithSums = 5;
constexpr uint64_t kProgressEvery = 256;

/// True for an error that another attempt may not meet. Everything else, also a statement that the
/// database no longer understands because its schema rotted, is damage.
bool is_passing(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsResourceExhausted(status);
}

/// Damage at the level of pages and indexes.
absl::Status verify_structure(Database& database, const std::string& path, Verification& verification) {
  Query check(database, "PRAGMA integrity_check(20)");
  while (check.next()) {
    if (check.text(0) != "ok") verification.damages.push_back({path, check.text(0)});
  }
  if (check.status().ok() || is_passing(check.status())) return check.status();
  verification.damages.push_back({path, std::string(check.status().message())});
  return absl::OkStatus();
}

absl::Status verify_table(Database& database, const SummedTable& table, Verification& verification,
                          const VerificationProgress& progress) {
  // A text has the sum of the same bytes, but nothing is written as text, and nothing finds one.
  const std::string types = absl::StrReplaceAll(table.columns, {{", ", "), typeof("}});
  const std::string sql =
      absl::StrCat("SELECT ", table.title, ", sum = row_sum('", table.name, "', ", table.columns,
                   ") AND 'text' NOT IN (typeof(", types, ")) FROM ", table.name, " ORDER BY ", table.key);
  Query row(database, sql.c_str());
  while (row.next()) {
    if (++verification.records % kProgressEvery == 0) progress(verification);
    if (row.is_true(1)) continue;
    // The name itself may be what rotted.
    verification.damages.push_back({absl::CHexEscape(row.text(0)), "its record is not what was written"});
  }
  if (row.status().ok() || is_passing(row.status())) return row.status();
  verification.damages.push_back({table.name, std::string(row.status().message())});
  return absl::OkStatus();
}

/// Says whether a file's record is there now, as another look at the database tells.
StillKept ask_database(Database& database) {
  return [&database](const std::string& path) {
    const auto files = list_kept_files(database);
    if (!files.ok()) return true;
    for (const KeptFile& file : *files) {
      if (file.path == path) return true;
    }
    return false;
  };
}

}  // namespace

absl::Status verify_records(Database& database, const std::string& path, Verification& verification,
                            const VerificationProgress& progress) {
  if (absl::Status done = verify_structure(database, path, verification); !done.ok()) return done;
  Query version(database, "PRAGMA user_version");
  if (!version.next()) return version.status();
  if (version.integer(0) < kFirstVersionWithSums) return absl::OkStatus();
  for (const SummedTable& table : kSummedTables) {
    if (version.integer(0) < table.since) continue;
    if (absl::Status done = verify_table(database, table, verification, progress); !done.ok()) return done;
  }
  return absl::OkStatus();
}

absl::Status verify_files(Database& database, const fs::path& root, const StillKept& still_kept,
                          Verification& verification, const VerificationProgress& progress) {
  const auto files = list_kept_files(database);
  if (!files.ok()) return files.status();
  for (const KeptFile& file : *files) {
    const auto bytes = check_kept_file(root, file);
    ++verification.files;
    verification.bytes += bytes.value_or(0);
    progress(verification);
    if (bytes.ok() || (still_kept != nullptr && !still_kept(file.path))) continue;
    verification.damages.push_back({absl::CHexEscape(file.name), std::string(bytes.status().message())});
  }
  return absl::OkStatus();
}

absl::StatusOr<Verification> verify_store(const fs::path& data, const VerificationProgress& progress) {
  const fs::path path = data / kDatabase;
  std::error_code error;
  if (fs::file_size(path, error) == 0 || error) {
    return absl::FailedPreconditionError(
        absl::StrCat("there is no store in ", data.string(), ": ", path.string(), " is missing or empty"));
  }
  const auto database = Database::open(path.string());
  if (!database.ok()) return database.status();
  if (absl::Status set = (*database)->execute("PRAGMA query_only = ON"); !set.ok()) return set;
  Verification verification;
  absl::Status done = verify_records(**database, path.string(), verification, progress);
  if (done.ok()) done = verify_files(**database, data, ask_database(**database), verification, progress);
  // A database that cannot be read at all is damaged; there is no more to be said of it.
  if (is_passing(done)) return done;
  if (!done.ok()) verification.damages.push_back({path.string(), std::string(done.message())});
  return verification;
}

}  // namespace lipofill::server
