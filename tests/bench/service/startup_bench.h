#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/plan_file.h"
#include "tests/bench/service/phase_times.h"

namespace lipofill::bench {

/// From the file of a scan to the first frame of a simulation on it, and its first step.
struct StartupTable {
  int triangles = 0;  ///< the scan's file has so many
  std::vector<Phase> phases;
  std::string state_hash;  ///< after the first step

  /// Wall time of all phases up to the first frame [ms].
  double first_frame_ms() const;
};

/// A daemon started for it and a client beside it; cpu_ms is the client's.
absl::StatusOr<StartupTable> measure_served_startup(const client::PlanFile& plan);

/// In this process, with the parts of building a model apart.
absl::StatusOr<StartupTable> measure_startup(const client::PlanFile& plan);

/// Writes the plan's scan with every triangle cut in four, `times` times over, in the format of the
/// file's extension.
absl::Status write_refined_scan(const client::PlanFile& plan, int times, const std::filesystem::path& file);

}  // namespace lipofill::bench
