#pragma once

#include <cstdint>
#include <filesystem>

#include "absl/status/statusor.h"
#include "server/store/checkpoint_files.h"
#include "server/store/scan_files.h"
#include "server/store/store.h"

namespace lipofill::server {

/// The files of scans and checkpoints that were found without a record.
struct Strays {
  int files = 0;
  std::filesystem::path place;  ///< where they are now
};

/// Moves files of no record to <data>/set-aside/<time>/: the database may be older than they are,
/// or another one's. They are not in the way there, and nothing removes them. Where one cannot be
/// moved, UNAVAILABLE or RESOURCE_EXHAUSTED. Called before anything is served, once the store's
/// temporary files are swept. Checked by tests/unit/server/store/stray_files_test.cc.
absl::StatusOr<Strays> set_strays_aside(Store& store, const ScanFiles& scans, const CheckpointFiles& checkpoints,
                                        const std::filesystem::path& data, int64_t now_us);

}  // namespace lipofill::server
