#include "server/store/backup.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/hash.h"
#include "server/store/data_directory.h"
#include "server/store/durable_file.h"
#include "server/store/kept_files.h"
#include "server/store/sqlite_database.h"
#include "server/store/store_opening.h"

namespace lipofill::server {
namespace {
namespace fs = std::filesystem;

constexpr char kSums[] = "SHA256SUMS";
constexpr char kDamaged[] = "DAMAGED";
constexpr uint64_t kMaxSumsBytes = uint64_t{256} << 20;
constexpr std::streamsize kChunk = 1 << 20;

/// Path below the root, and the SHA-256 of the content in hex.
using Sums = std::map<std::string, std::string>;

/// Links to files in the data directory, so that they stay while they are copied, whatever the
/// daemon deletes.
class Staging {
 public:
  explicit Staging(const fs::path& data) : root_(data / absl::StrCat(kPrefix, ::getpid())) { sweep(data); }
  ~Staging() {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }
  /// A file that is not there is left out: a scan of which nothing has come yet.
  absl::Status link(const fs::path& data, const std::string& path) {
    std::error_code error;
    if (!fs::exists(data / path, error)) return absl::OkStatus();
    fs::create_directories((root_ / path).parent_path(), error);
    if (!error) fs::create_hard_link(data / path, root_ / path, error);
    if (error) return file_error(absl::StrCat("cannot link ", (data / path).string()), error.value());
    linked_.push_back(path);
    return absl::OkStatus();
  }
  const std::vector<std::string>& linked() const { return linked_; }
  fs::path file(const std::string& path) const { return root_ / path; }

 private:
  /// Removes the files of backups that did not finish.
  static void sweep(const fs::path& data) {
    std::error_code error;
    std::vector<fs::path> left;
    for (const auto& entry : fs::directory_iterator(data, error)) {
      const std::string name = entry.path().filename().string();
      int pid = 0;
      if (!absl::StartsWith(name, kPrefix) || !absl::SimpleAtoi(name.substr(kPrefix.size()), &pid)) continue;
      if (::kill(pid, 0) != 0 && errno == ESRCH) left.push_back(entry.path());
    }
    for (const fs::path& path : left) fs::remove_all(path, error);
  }

  static constexpr absl::string_view kPrefix = "backup-";
  fs::path root_;
  std::vector<std::string> linked_;
};

/// Links the files with the daemon's writes held up, so that no file goes whose record is in the
/// reader's view of the database.
absl::Status link_files(Database& writer, Database& reader, const fs::path& data, Staging& staging) {
  const Transaction hold(writer);
  if (!hold.status().ok()) return hold.status();
  if (absl::Status begun = reader.execute("BEGIN"); !begun.ok()) return begun;
  const auto files = list_kept_files(reader);
  if (!files.ok()) return files.status();
  for (const KeptFile& file : *files) {
    if (absl::Status linked = staging.link(data, file.path); !linked.ok()) return linked;
  }
  return absl::OkStatus();
}

/// The sum of what was copied. With an empty target nothing is written.
absl::StatusOr<std::string> copy_and_sum(const fs::path& source, const fs::path& target, BackupReport& report) {
  std::ifstream in(source, std::ios::binary);
  if (!in) return absl::DataLossError(absl::StrCat(source.string(), " cannot be read"));
  std::ofstream out;
  if (!target.empty()) {
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    out.open(target, std::ios::binary | std::ios::trunc);
  }
  Hasher hasher;
  std::string chunk(static_cast<size_t>(kChunk), '\0');
  while (in.read(chunk.data(), kChunk) || in.gcount() > 0) {
    const std::streamsize n = in.gcount();
    hasher.add_bytes(chunk.data(), static_cast<size_t>(n));
    report.bytes += static_cast<uint64_t>(n);
    if (!target.empty()) out.write(chunk.data(), n);
  }
  ++report.files;
  out.close();
  if (!target.empty()) {
    if (!out) return file_error(absl::StrCat("cannot write ", target.string()), errno);
    if (absl::Status flushed = flush_to_medium(target); !flushed.ok()) return flushed;
  }
  return hasher.hex_digest();
}

std::string to_text(const Sums& sums) {
  std::string text;
  for (const auto& [path, sum] : sums) absl::StrAppend(&text, sum, "  ", path, "\n");
  return text;
}

std::string to_text(const std::vector<Damage>& damages) {
  std::string text;
  for (const Damage& damage : damages) absl::StrAppend(&text, damage.name, ": ", damage.what, "\n");
  return text;
}

/// Reads the sums. DATA_LOSS for a line that is none, or a path that leads elsewhere.
absl::StatusOr<Sums> read_sums(const fs::path& root) {
  const auto text = read_whole_file(root / kSums, kMaxSumsBytes);
  if (!text.ok()) {
    return absl::FailedPreconditionError(
        absl::StrCat(root.string(), " is no complete backup: ", std::string(text.status().message())));
  }
  Sums sums;
  size_t begin = 0;
  while (begin < text->size()) {
    const size_t end = std::min(text->find('\n', begin), text->size());
    const std::string line = text->substr(begin, end - begin);
    begin = end + 1;
    const fs::path path = line.size() > 66 ? line.substr(66) : std::string();
    const bool leads_out = path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end();
    if (path.empty() || leads_out) return absl::DataLossError(absl::StrCat((root / kSums).string(), " is damaged"));
    sums[path.string()] = line.substr(0, 64);
  }
  if (sums.count(kDatabaseFile) == 0)
    return absl::DataLossError(absl::StrCat((root / kSums).string(), " has no database"));
  return sums;
}

absl::Status check_sums(const fs::path& root, const Sums& sums) {
  BackupReport ignored;
  for (const auto& [path, sum] : sums) {
    const auto found = copy_and_sum(root / path, {}, ignored);
    if (!found.ok()) return found.status();
    if (*found != sum) return absl::DataLossError(absl::StrCat((root / path).string(), " is not what was backed up"));
  }
  return absl::OkStatus();
}

/// Checks records and files of a copy against what was written.
absl::Status look_for_damage(const fs::path& root, const fs::path& path, BackupReport& report) {
  const auto database = SqliteDatabase::open(path.string());
  if (!database.ok()) return database.status();
  Verification found;
  absl::Status looked = verify_records(**database, found, [](const Verification&) {});
  if (looked.ok()) looked = verify_files(**database, root, nullptr, found, [](const Verification&) {});
  report.damages = std::move(found.damages);
  return looked;
}

absl::Status fill(const fs::path& data, const fs::path& partial, const BackupProgress& progress, BackupReport& report) {
  const auto reader = SqliteDatabase::open((data / kDatabaseFile).string());
  if (!reader.ok()) return reader.status();
  Staging staging(data);
  {
    const auto writer = SqliteDatabase::open((data / kDatabaseFile).string());
    absl::Status linked = writer.status();
    if (linked.ok()) linked = link_files(**writer, **reader, data, staging);
    if (!linked.ok()) return linked;
  }
  if (absl::Status copied = (*reader)->copy_to((partial / kDatabaseFile).string()); !copied.ok()) return copied;
  Sums sums;
  const auto database_sum = copy_and_sum(partial / kDatabaseFile, {}, report);
  if (!database_sum.ok()) return database_sum.status();
  sums[kDatabaseFile] = *database_sum;
  for (const std::string& path : staging.linked()) {
    const auto sum = copy_and_sum(staging.file(path), partial / path, report);
    if (!sum.ok()) return sum.status();
    sums[path] = *sum;
    progress(report);
  }
  if (absl::Status looked = look_for_damage(partial, partial / kDatabaseFile, report); !looked.ok()) return looked;
  if (!report.damages.empty()) {
    const absl::Status named = write_durably(partial / kDamaged, to_text(report.damages));
    if (!named.ok()) return named;
  }
  return write_durably(partial / kSums, to_text(sums));
}

}  // namespace

absl::StatusOr<BackupReport> back_up_store(const fs::path& data, const fs::path& target,
                                           const BackupProgress& progress) {
  std::error_code error;
  if (!fs::exists(data / kDatabaseFile, error)) {
    return absl::FailedPreconditionError(absl::StrCat("there is no store in ", data.string()));
  }
  if (fs::exists(target, error)) return absl::FailedPreconditionError(absl::StrCat(target.string(), " exists"));
  const fs::path partial = target.string() + ".partial";
  fs::remove_all(partial, error);
  fs::create_directories(partial, error);
  if (error) return file_error(absl::StrCat("cannot make ", partial.string()), error.value());
  fs::permissions(partial, fs::perms::owner_all, error);
  BackupReport report;
  if (absl::Status filled = fill(data, partial, progress, report); !filled.ok()) return filled;
  fs::rename(partial, target, error);
  if (error) return file_error(absl::StrCat("cannot make ", target.string()), error.value());
  return report;
}

absl::StatusOr<BackupReport> restore_store(const fs::path& source, const fs::path& data,
                                           const BackupProgress& progress) {
  const auto sums = read_sums(source);
  if (!sums.ok()) return sums.status();
  const auto directory = DataDirectory::open(data);
  if (!directory.ok()) return directory.status();
  if (absl::Status empty = check_holds_no_store(*directory); !empty.ok()) return empty;
  if (absl::Status whole = check_sums(source, *sums); !whole.ok()) return whole;
  BackupReport report;
  const auto copy = [&](const std::string& path, const fs::path& target) -> absl::Status {
    const auto sum = copy_and_sum(source / path, target, report);
    if (!sum.ok()) return sum.status();
    progress(report);
    return *sum == sums->at(path) ? absl::OkStatus()
                                  : absl::DataLossError(absl::StrCat((source / path).string(), " changed meanwhile"));
  };
  for (const auto& [path, sum] : *sums) {
    if (path == kDatabaseFile) continue;
    if (absl::Status copied = copy(path, data / path); !copied.ok()) return copied;
  }
  // The database comes last and in one go: without it there is no store.
  const fs::path draft = data / absl::StrCat(kDatabaseFile, ".new");
  if (absl::Status copied = copy(kDatabaseFile, draft); !copied.ok()) return copied;
  if (absl::Status looked = look_for_damage(data, draft, report); !looked.ok()) return looked;
  std::error_code error;
  fs::rename(draft, directory->database(), error);
  if (error) return file_error(absl::StrCat("cannot make ", directory->database().string()), error.value());
  return report;
}

}  // namespace lipofill::server
