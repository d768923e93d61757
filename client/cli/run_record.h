#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::client {

/// run.json in a folder of results: where they came from, so that the folder can be evaluated and
/// drawn later.
struct RunRecord {
  std::string plan;
  std::string simulation;
  std::string server;  ///< empty when a private daemon ran it
  std::string data;    ///< the private daemon's state, relative to the folder
  bool kept = true;    ///< the simulation is still there
  std::optional<std::array<double, 3>> up;
};

absl::Status write_run_record(const std::filesystem::path& folder, const RunRecord& record);

/// Reads the record of a run. INVALID_ARGUMENT for a folder that no run has written.
absl::StatusOr<RunRecord> read_run_record(const std::filesystem::path& folder);

}  // namespace lipofill::client
