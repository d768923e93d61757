#include "server/store/verification.h"

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "server/store/database_opening.h"
#include "server/store/kept_files.h"
#include "server/store/row_sums.h"

namespace lipofill::server {
namespace fs = std::filesystem;
namespace {

constexpr int kFirstVersionWithSums = 5;
constexpr uint64_t kProgressEvery = 256;

/// True for an error that another attempt may not meet. Everything else, also a statement that the
/// database no longer understands because its schema rotted, is damage.
bool is_passing(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsResourceExhausted(status);
}

/// Damage at the level of pages and indexes.
absl::Status verify_structure(Database& database, Verification& verification) {
  const auto faults = database.find_faults();
  if (is_passing(faults.status())) return faults.status();
  if (!faults.ok()) verification.damages.push_back({database.name(), std::string(faults.status().message())});
  for (const std::string& fault : faults.value_or(std::vector<std::string>())) {
    verification.damages.push_back({database.name(), fault});
  }
  return absl::OkStatus();
}

/// The name of what a row that check_rows() found is of; the name itself may be what rotted.
std::string title_of(const SummedTable& table, const Query& row) {
  std::string title = table.title;
  const std::vector<std::string> columns = absl::StrSplit(table.named, ", ");
  for (size_t i = 0; i < columns.size(); ++i) {
    title = absl::StrReplaceAll(title, {{absl::StrCat("$", i), row.text(static_cast<int>(i) + 1)}});
  }
  return absl::CHexEscape(title);
}

absl::Status verify_table(Database& database, const SummedTable& table, Verification& verification,
                          const VerificationProgress& progress) {
  Query row(database, check_rows(table, !database.is_shared()).c_str());
  while (row.next()) {
    if (++verification.records % kProgressEvery == 0) progress(verification);
    if (row.is_true(0)) continue;
    verification.damages.push_back({title_of(table, row), "its record is not what was written"});
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

absl::Status verify_records(Database& database, Verification& verification, const VerificationProgress& progress) {
  if (absl::Status done = verify_structure(database, verification); !done.ok()) return done;
  const auto version = database.schema_version();
  if (!version.ok()) return version.status();
  if (*version < kFirstVersionWithSums) return absl::OkStatus();
  for (const SummedTable& table : kSummedTables) {
    if (*version < table.since) continue;
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

absl::StatusOr<Verification> verify_store(const fs::path& data, const std::string& place,
                                          const VerificationProgress& progress) {
  const auto database = open_database_to_look(place);
  if (!database.ok()) return database.status();
  Verification verification;
  absl::Status done = verify_records(**database, verification, progress);
  if (done.ok()) done = verify_files(**database, data, ask_database(**database), verification, progress);
  // A database that cannot be read at all is damaged; there is no more to be said of it.
  if (is_passing(done)) return done;
  if (!done.ok()) verification.damages.push_back({(*database)->name(), std::string(done.message())});
  return verification;
}

}  // namespace lipofill::server
