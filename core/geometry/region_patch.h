#pragma once

#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/surface_locator.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// The piece of outer skin around a region: one part, a little larger than the region, its small
/// holes filled.
struct RegionPatch {
  SurfaceMesh mesh;
  std::vector<int> whole_of_vertex;     ///< vertex of the cleaned scan, -1 for the middle of a filled hole
  std::array<SurfacePoint, 4> corners;  ///< they lie on `mesh`
  std::vector<std::string> remarks;
};

/// The skin whose distances along the surface to the four corners add up to little more than those
/// of a corner to the others: a convex surrounding of the quadrilateral.
/// @param skin     the outer skin near the region, one surface
/// @param corners  on `skin`
/// INVALID_ARGUMENT (fields "scan_region.corners[k]", "scan_region.corners") for corners on
/// separate pieces of skin or out of bounds.
absl::StatusOr<RegionPatch> cut_region_patch(const SurfaceMesh& skin, const std::array<SurfacePoint, 4>& corners);

}  // namespace lipofill::geometry
