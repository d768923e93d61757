#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::server {

/// The amount that a backup or a restore copied.
struct BackupReport {
  int files = 0;
  uint64_t bytes = 0;
};

/// It is called after every file.
using BackupProgress = std::function<void(const BackupReport& so_far)>;

/// Copies a store to a new directory, while a daemon serves it or not: the database as it is at one
/// moment, and the scans and checkpoints it speaks of then.
///
///     <target>/lipofill.sqlite  scans/<patient>/<scan>  checkpoints/<simulation>/<checkpoint>  SHA256SUMS
///
/// SHA256SUMS is what `sha256sum -c` takes. Everything is on the medium when this returns; a target
/// that is not complete is called <target>.partial. The daemon's writes wait for some milliseconds,
/// while links to the files are made. FAILED_PRECONDITION for a source without a database or a
/// target that exists; RESOURCE_EXHAUSTED when there is no room. Checked by
/// tests/unit/server/store/backup_test.cc and tests/integration/service/backup_test.cc.
absl::StatusOr<BackupReport> back_up_store(const std::filesystem::path& data, const std::filesystem::path& target,
                                           const BackupProgress& progress);

/// Fills a data directory that has no database from a backup; every file is checked against
/// SHA256SUMS first. DATA_LOSS naming a file that is missing or is not what it was; nothing is
/// changed then. FAILED_PRECONDITION when the directory has a database, or a daemon uses it.
absl::StatusOr<BackupReport> restore_store(const std::filesystem::path& source, const std::filesystem::path& data,
                                           const BackupProgress& progress);

}  // namespace lipofill::server
