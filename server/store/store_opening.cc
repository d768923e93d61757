#include "server/store/store_opening.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "server/store/database_opening.h"
#include "server/store/durable_file.h"

namespace lipofill::server {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t kMaxIdentityBytes = 4096;

std::string to_text(const StoreIdentity& identity) {
  return absl::StrCat(identity.id, " ", identity.starts, "\n");
}

/// Reads what the directory says; none where it does not say anything.
absl::StatusOr<std::optional<StoreIdentity>> read_identity(const fs::path& path) {
  const auto text = read_whole_file(path, kMaxIdentityBytes);
  if (absl::IsNotFound(text.status())) return std::nullopt;
  if (!text.ok()) return text.status();
  const std::vector<std::string> words = absl::StrSplit(*text, absl::ByAnyChar(" \n"), absl::SkipEmpty());
  StoreIdentity identity;
  if (words.size() != 2 || !absl::SimpleAtoi(words[1], &identity.starts)) {
    return absl::FailedPreconditionError(
        absl::StrCat(path.string(), " does not say which store this is; remove it if the database belongs here"));
  }
  identity.id = words[0];
  return identity;
}

/// A file below the directory, as an example of those there are; empty where there is none.
fs::path any_file_in(const fs::path& root) {
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(root, error)) {
    if (entry.is_regular_file(error)) return entry.path();
  }
  return {};
}

/// Tells what a directory holds of a store besides the database; empty where that is nothing.
std::string other_parts(const DataDirectory& data) {
  std::error_code error;
  if (fs::exists(data.identity(), error)) return data.identity().string();
  for (const fs::path& root : {data.scans(), data.checkpoints()}) {
    if (const fs::path file = any_file_in(root); !file.empty()) return file.string();
  }
  return "";
}

/// Says what is not as it should be with a file of SQLite, or with a database of PostgreSQL, that
/// holds no store.
std::string without_store(const std::string& place) {
  std::error_code error;
  if (is_postgres(place)) return "the database holds no store";
  return absl::StrCat(place, fs::exists(place, error) ? " is empty" : " is missing");
}

/// A store is made only where there is nothing of one.
absl::Status check_database_is_there(const DataDirectory& data, const std::string& place) {
  const auto is_there = holds_store(place);
  if (!is_there.ok()) return is_there.status();
  const std::string part = *is_there ? "" : other_parts(data);
  if (part.empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(without_store(place), ", but there is ", part,
                                                    ": put the database back from a backup; or move all of ",
                                                    data.path().string(), " away to begin with an empty store"));
}

absl::Status check_same_store(const DataDirectory& data, const std::string& database, const StoreIdentity& in_directory,
                              const StoreIdentity& in_database) {
  if (in_directory.id == in_database.id) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      database, " is the database of another data directory: its store is ", in_database.id, ", that of ",
      data.path().string(), " is ", in_directory.id,
      ". Put the right one in its place; or, if they do belong together, remove ", data.identity().string()));
}

/// A directory that says nothing may be a new one, or one that was not mounted: a database that is
/// elsewhere and was served before has files somewhere.
absl::Status check_not_lost(const DataDirectory& data, const Database& database, const StoreIdentity& in_database) {
  if (!database.is_shared() || in_database.starts == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      data.path().string(), " does not say that it belongs to the store ", in_database.id, " in ", database.name(),
      ", which was served before: mount the directory that has its files; or, if this "
      "is it, write the line \"",
      in_database.id, " 0\" to ", data.identity().string()));
}

std::string remark_on_age(const StoreIdentity& in_directory, const StoreIdentity& in_database) {
  if (in_directory.starts <= in_database.starts) return "";
  return absl::StrCat("the database is older than its directory: it knows of ", in_database.starts,
                      " starts, the directory of ", in_directory.starts,
                      "; what was made since is not in it, and files of that are set aside");
}

}  // namespace

absl::Status check_holds_no_store(const DataDirectory& data) {
  std::error_code error;
  const std::string part = fs::exists(data.database(), error) ? data.database().string() : other_parts(data);
  if (part.empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat(data.path().string(), " has a store: there is ", part, "; take an empty directory"));
}

absl::StatusOr<OpenedStore> open_store_to_serve(const DataDirectory& data, const std::string& place) {
  if (absl::Status there = check_database_is_there(data, place); !there.ok()) return there;
  const auto in_directory = read_identity(data.identity());
  if (!in_directory.ok()) return in_directory.status();
  auto store = SqlStore::open(place);
  if (!store.ok()) return store.status();
  const auto in_database = (*store)->read_identity();
  if (!in_database.ok()) return in_database.status();
  const Database& database = (*store)->database();
  OpenedStore opened;
  StoreIdentity now = *in_database;
  if (in_directory->has_value()) {
    if (auto same = check_same_store(data, database.name(), **in_directory, now); !same.ok()) return same;
    opened.remark = remark_on_age(**in_directory, *in_database);
    now.starts = std::max(now.starts, (*in_directory)->starts);
  } else if (absl::Status found = check_not_lost(data, database, now); !found.ok()) {
    return found;
  }
  // Without room the start goes uncounted; there is no reason not to serve in that.
  ++now.starts;
  if ((*store)->set_starts(now.starts).ok()) write_durably(data.identity(), to_text(now)).IgnoreError();
  opened.store = *std::move(store);
  return opened;
}

}  // namespace lipofill::server
