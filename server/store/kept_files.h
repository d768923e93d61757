#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/database.h"

namespace lipofill::server {

/// A file that a record speaks of.
struct KeptFile {
  std::string path;        ///< below the data directory
  std::string name;        ///< of the resource
  bool is_scan = true;     ///< else a checkpoint
  bool is_whole = true;    ///< else a scan of which bytes have yet to come, perhaps all
  std::string simulation;  ///< of a checkpoint
  std::string sha256;      ///< of a scan's file, or of a checkpoint's body
};

/// The files that a database speaks of, in order of their paths.
absl::StatusOr<std::vector<KeptFile>> list_kept_files(Database& database);

/// Reads a file, whose size it returns. DATA_LOSS saying how it is not the one that was written.
absl::StatusOr<uint64_t> check_kept_file(const std::filesystem::path& root, const KeptFile& file);

}  // namespace lipofill::server
