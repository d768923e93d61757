#pragma once

#include <Eigen/Core>
#include <memory>

#include "core/geometry/face_geometry.h"
#include "core/geometry/skin_reach.h"
#include "core/geometry/surface_locator.h"

namespace lipofill::geometry {

/// Foot of a point on the bilinear skin of a grid.
struct SkinFoot {
  ChartPoint place;       ///< outside [0, 1] for points beyond the rim
  double distance = 0.0;  ///< [m] from the skin at `place`, moved into [0, 1]
};

/// Finds feet by Newton's method in the cells of the grid, starting from the nearest facet; beyond
/// the rim the cells go on bilinearly.
class SkinProjection {
 public:
  explicit SkinProjection(const LayeredGrid& grid);
  SkinFoot project(const Eigen::Vector3d& point) const;

  /// Two triangles a cell of the grid.
  const SurfaceMesh& facets() const { return facets_; }

 private:
  const LayeredGrid& grid_;
  SurfaceMesh facets_;
  std::unique_ptr<SurfaceLocator> locator_;
};

/// The position a skin point asks for, before it is projected onto the skin [m]. INVALID_ARGUMENT
/// (field violation "") for a landmark that is not there, weights that do not add up to a positive
/// number, a value that is not finite, and for a ChartPoint.
absl::StatusOr<Eigen::Vector3d> resolve_position(const SkinPoint& point, const Landmarks& landmarks,
                                                 const HeadAxes& axes);

}  // namespace lipofill::geometry
