#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/verification.h"

namespace lipofill::server {

/// The amount that a backup or a restore copied, and what of it is not what was written.
struct BackupReport {
  int files = 0;
  uint64_t bytes = 0;
  std::vector<Damage> damages;
};

/// It is called after every file.
using BackupProgress = std::function<void(const BackupReport& so_far)>;

/// Copies a store to a new directory, while a daemon serves it or not: the database as it is at one
/// moment, and the scans and checkpoints it speaks of then.
///
///     <target>/lipofill.sqlite  scans/<patient>/<scan>  checkpoints/<simulation>/<checkpoint>  SHA256SUMS
///
/// Every record and every file is checked on the way, in the copy. What is damaged is copied as it
/// is and named in the report and in the file DAMAGED: the rest is worth a backup all the same, and
/// the store that comes of it knows the damage too.
///
/// SHA256SUMS is what `sha256sum -c` takes. Everything is on the medium when this returns; a target
/// that is not complete is called <target>.partial. The daemon's writes wait for some milliseconds,
/// while links to the files are made. FAILED_PRECONDITION for a source without a database or a
/// target that exists; RESOURCE_EXHAUSTED when there is no room. Checked by
/// tests/unit/server/store/backup_test.cc and tests/integration/service/backup_test.cc.
absl::StatusOr<BackupReport> back_up_store(const std::filesystem::path& data, const std::filesystem::path& target,
                                           const BackupProgress& progress);

/// Fills a data directory that has nothing of a store from a backup; every file is checked against
/// SHA256SUMS first. DATA_LOSS naming a file that is missing or is not what it was; nothing is
/// changed then. FAILED_PRECONDITION when the directory has a store, or a daemon uses it. The
/// report names what was damaged when the backup was made.
absl::StatusOr<BackupReport> restore_store(const std::filesystem::path& source, const std::filesystem::path& data,
                                           const BackupProgress& progress);

}  // namespace lipofill::server
