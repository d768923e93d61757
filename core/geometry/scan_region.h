#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/chart_around.h"
#include "core/geometry/face_geometry.h"
#include "core/geometry/region_patch.h"

namespace lipofill::geometry {

/// The outer skin around a region of a scan, before it is charted.
struct ScanRegion {
  RegionPatch patch;  ///< whole_of_vertex: into the cleaned scan
  /// This says what to chart where the region follows from footprints, their centres on the skin;
  /// the patch has no corners then.
  std::optional<ChartAroundRequest> around;
  HeadAxes axes;
  std::vector<int> cleaned_of_scan;   ///< cleaned vertex of each vertex of the scan, -1 where none
  std::vector<std::string> remarks;   ///< what cleaning did, a sentence each
  std::vector<std::string> cautions;  ///< what is unusual about scan, landmarks and region, a sentence each
};

/// The axes of the head as given, or estimated from the landmarks; nothing where that is not
/// possible and no corner needs them. INVALID_ARGUMENT for axes that are no frame,
/// FAILED_PRECONDITION saying which landmarks are missing.
absl::StatusOr<std::optional<HeadAxes>> find_axes(const ScanRegionSpec& spec);

/// Cleans the scan, turns it right side out, checks the landmarks, places the corners or the
/// footprints on its outer skin and cuts the patch around them.
/// Errors as build_face_geometry.
absl::StatusOr<ScanRegion> find_scan_region(const ScanRegionSpec& spec, const Progress& progress);

}  // namespace lipofill::geometry
