#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "client/cli/report_fetch.h"

namespace lipofill::client {

/// The largest sizes on the skin that the colours of a report end at, rounded up.
struct ReportScales {
  double displacement_mm = 0.0;
  double distance_mm = 0.0;
  double line_mm = 1.0;
};

/// Writes the surfaces that a report draws into a folder: before.vtp, planned.vtp, remaining.vtp,
/// and with a target target.vtp, deficit.vtp, planned-distance.vtp and remaining-distance.vtp. All
/// are moved near the origin together where the scan lies far from it: pictures are drawn in single
/// precision.
/// @return the centre of the landmarks in that place, where there are landmarks, and the scales
struct WrittenMeshes {
  std::optional<std::array<double, 3>> centre;
  ReportScales scales;
};
absl::StatusOr<WrittenMeshes> write_report_meshes(const ReportFetch& fetch, const std::filesystem::path& folder);

}  // namespace lipofill::client
