#pragma once

#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/face_geometry.h"
#include "core/geometry/region_patch.h"

namespace lipofill::geometry {

/// The outer skin around a region of a scan, before it is charted.
struct ScanRegion {
  RegionPatch patch;  ///< whole_of_vertex: into the cleaned scan
  HeadAxes axes;
  std::vector<int> cleaned_of_scan;  ///< cleaned vertex of each vertex of the scan, -1 where none
  std::vector<std::string> remarks;
};

/// Cleans the scan, turns it right side out, places the corners on its outer skin and cuts the
/// patch around them. Errors as build_face_geometry.
absl::StatusOr<ScanRegion> find_scan_region(const ScanRegionSpec& spec, const Progress& progress);

}  // namespace lipofill::geometry
