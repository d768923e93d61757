#include "server/store/temporary_files.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "server/store/durable_file.h"

namespace lipofill::server {
namespace fs = std::filesystem;
namespace {

/// True for the path of a scan or a checkpoint of which there is no record. A note that rotted must
/// lead nowhere else.
bool may_go(Store& store, const std::string& path) {
  const std::vector<std::string> parts = absl::StrSplit(path, '/');
  if (parts.size() != 3 || (parts[0] != "scans" && parts[0] != "checkpoints")) return false;
  const bool leads_out = std::any_of(parts.begin(), parts.end(), [](const std::string& part) {
    return part.empty() || part == "." || part == ".." || part.find('\0') != std::string::npos;
  });
  if (leads_out) return false;
  const absl::Status record = parts[0] == "scans" ? store.get_scan(parts[1], parts[2]).status()
                                                  : store.get_checkpoint(parts[1], parts[2]).status();
  return absl::IsNotFound(record);
}

}  // namespace

std::string scan_path(const std::string& patient, const std::string& scan) {
  return absl::StrCat("scans/", patient, "/", scan);
}

std::string checkpoint_path(const std::string& simulation, const std::string& checkpoint) {
  return absl::StrCat("checkpoints/", simulation, "/", checkpoint);
}

absl::Status TemporaryFiles::begin(const std::string& path) {
  const std::lock_guard lock(mutex_);
  return store_.note_draft(path);
}

void TemporaryFiles::give_up(const std::string& path) {
  const std::lock_guard lock(mutex_);
  remove_file(path);
  store_.forget_temporary_files({path}).IgnoreError();  // the next start does
}

void TemporaryFiles::remove_deleted() {
  const std::lock_guard lock(mutex_);
  remove(false);
}

int TemporaryFiles::sweep() {
  const std::lock_guard lock(mutex_);
  return remove(true);
}

int TemporaryFiles::remove(bool drafts_too) {
  const auto files = store_.list_temporary_files();
  if (!files.ok()) return 0;
  std::vector<std::string> removed;
  for (const TemporaryFile& file : *files) {
    if (file.is_draft && !drafts_too) continue;
    if (may_go(store_, file.path)) remove_file(file.path);
    removed.push_back(file.path);
  }
  store_.forget_temporary_files(removed).IgnoreError();  // they are looked for again, and are not there
  return static_cast<int>(removed.size());
}

void TemporaryFiles::remove_file(const std::string& path) const {
  std::error_code ignored;
  const fs::path file = data_ / path;
  fs::remove(file, ignored);
  fs::remove(draft_of(file), ignored);
  fs::remove(file.parent_path(), ignored);  // only when it is empty
}

}  // namespace lipofill::server
