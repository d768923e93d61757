#include "server/store/database_opening.h"

#include <filesystem>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/store/postgres_database.h"
#include "server/store/postgres_schema.h"
#include "server/store/schema.h"
#include "server/store/sqlite_database.h"

namespace lipofill::server {
namespace {

absl::StatusOr<std::unique_ptr<Database>> open_sqlite(const std::string& path) {
  auto database = SqliteDatabase::open(path);
  if (!database.ok()) return database.status();
  if (auto whole = check_database(**database, path); !whole.ok()) return whole;
  if (auto ready = bring_up_to_date(**database, path); !ready.ok()) return ready;
  // FULL: what was acknowledged survives a loss of power too, not only the end of the process.
  constexpr char kSettings[] =
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON; PRAGMA trusted_schema = OFF";
  if (auto set = (*database)->execute(kSettings); !set.ok()) return set;
  return database;
}

absl::StatusOr<std::unique_ptr<Database>> open_postgres(const std::string& address) {
  auto database = PostgresDatabase::open(address);
  if (!database.ok()) return database.status();
  if (auto ready = bring_postgres_up_to_date(**database); !ready.ok()) return ready;
  return database;
}

bool has_bytes(const std::string& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return !error && size > 0;
}

absl::StatusOr<std::unique_ptr<Database>> open_sqlite_to_look(const std::string& path) {
  if (!has_bytes(path)) {
    return absl::FailedPreconditionError(absl::StrCat("there is no store in ",
                                                      std::filesystem::path(path).parent_path().string(), ": ", path,
                                                      " is missing or empty"));
  }
  auto database = SqliteDatabase::open(path);
  if (!database.ok()) return database.status();
  if (absl::Status set = (*database)->execute("PRAGMA query_only = ON"); !set.ok()) return set;
  return database;
}

absl::StatusOr<std::unique_ptr<Database>> open_postgres_to_look(const std::string& address) {
  auto database = PostgresDatabase::open(address);
  if (!database.ok()) return database.status();
  if (absl::Status set = (*database)->execute("SET default_transaction_read_only = on"); !set.ok()) return set;
  if (absl::Status there = check_postgres_schema(**database); !there.ok()) return there;
  return database;
}

}  // namespace

bool is_postgres(const std::string& place) {
  return absl::StartsWith(place, "postgresql://") || absl::StartsWith(place, "postgres://");
}

absl::StatusOr<std::unique_ptr<Database>> open_database(const std::string& place) {
  return is_postgres(place) ? open_postgres(place) : open_sqlite(place);
}

absl::StatusOr<bool> holds_store(const std::string& place) {
  if (!is_postgres(place)) return has_bytes(place);
  const auto database = PostgresDatabase::open(place);
  if (!database.ok()) return database.status();
  return holds_postgres_store(**database);
}

absl::StatusOr<std::unique_ptr<Database>> open_database_to_look(const std::string& place) {
  return is_postgres(place) ? open_postgres_to_look(place) : open_sqlite_to_look(place);
}

}  // namespace lipofill::server
