#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/geometry/ray_tree.h"
#include "core/geometry/surface_locator.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// Farthest a point may lie from the skin it is projected to [m].
inline constexpr double kFarthestFromSkin = 0.010;
/// Farthest a point given by landmarks may lie beneath the skin: means of landmarks lie inside the
/// face [m].
inline constexpr double kDeepestUnderSkin = 0.045;

/// Carries points to the skin of a face. A point near the skin moves to the nearest place on it. A
/// point that lies deeper, as means of landmarks do on a face that bulges between them, follows the
/// outward normal: that of the skin around the point, each facet weighted by its area times
/// exp(-(d - s)^2 / (2 s^2)), d its distance from the point and s that of the nearest place. The
/// nearest place itself is no good there, as it lies in whatever hollow is close by.
/// Checked by tests/unit/geometry/skin_reach_test.cc.
class SkinReach {
 public:
  explicit SkinReach(const SurfaceMesh& skin);

  /// The place on the skin, with its distance from the point. Nothing for a point farther than 10
  /// mm above the skin or 45 mm beneath it.
  std::optional<SurfacePoint> reach(const Eigen::Vector3d& point) const;

  SurfacePoint find_nearest(const Eigen::Vector3d& point) const { return locator_.find_nearest(point); }

  /// Outward normal of the skin around a point, over about `length` [m].
  Eigen::Vector3d compute_normal(const Eigen::Vector3d& point, double length) const;

 private:
  const SurfaceMesh& skin_;
  SurfaceLocator locator_;
  RayTree rays_;
};

}  // namespace lipofill::geometry
