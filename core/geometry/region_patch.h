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

/// A disc of skin, its radius measured along the surface.
struct SkinDisc {
  SurfacePoint centre;
  double radius = 0.0;  ///< [m]
};

/// The skin within the discs (along edges of the scan, which are up to 1.2 times too long), the
/// part of it that holds the centre of the first; its corners are of no meaning.
/// FAILED_PRECONDITION when there is too much of it.
absl::StatusOr<RegionPatch> cut_patch_around(const SurfaceMesh& skin, const std::vector<SkinDisc>& discs);

}  // namespace lipofill::geometry
