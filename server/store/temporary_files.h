#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "server/store/store.h"

namespace lipofill::server {

/// Removes files below the data directory, and none but those that the store has recorded as
/// temporary: those of records that were deleted, and at the start what was being written when the
/// daemon died. A file that merely has no record is never removed. Thread-safe.
/// Checked by tests/unit/server/store/temporary_files_test.cc.
class TemporaryFiles {
 public:
  TemporaryFiles(Store& store, std::filesystem::path data) : store_(store), data_(std::move(data)) {}

  /// Notes a file that is about to be written; the record that it is for takes the note away.
  absl::Status begin(const std::string& path);
  /// Removes a file that was begun and gets no record.
  void give_up(const std::string& path);
  /// Removes the files whose records were deleted.
  void remove_deleted();
  /// Removes these and what was being written; for the start of the daemon. Returns how many there
  /// were.
  int sweep();

 private:
  /// With the mutex held.
  int remove(bool drafts_too);
  void remove_file(const std::string& path) const;

  Store& store_;
  const std::filesystem::path data_;
  std::mutex mutex_;  ///< no file is begun between the look at the notes and the removal
};

/// The paths that notes are made of.
std::string scan_path(const std::string& patient, const std::string& scan);
std::string checkpoint_path(const std::string& simulation, const std::string& checkpoint);

}  // namespace lipofill::server
