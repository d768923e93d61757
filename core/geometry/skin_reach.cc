#include "core/geometry/skin_reach.h"

#include <cmath>

#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {

SkinReach::SkinReach(const SurfaceMesh& skin) : skin_(skin), locator_(skin), rays_(skin) {}

Eigen::Vector3d SkinReach::compute_normal(const Eigen::Vector3d& point, double length) const {
  const double nearest = locator_.find_nearest(point).distance;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& triangle : skin_.triangles) {
    const Eigen::Vector3d centre =
        (skin_.points.col(triangle[0]) + skin_.points.col(triangle[1]) + skin_.points.col(triangle[2])) / 3.0;
    // Measured beyond the nearest place, so that the weights do not all vanish far from the skin.
    const double farther = (centre - point).norm() - nearest;
    sum += std::exp(-0.5 * (farther / length) * (farther / length)) * compute_area_vector(skin_, triangle);
  }
  return sum.normalized();
}

std::optional<SurfacePoint> SkinReach::reach(const Eigen::Vector3d& point) const {
  const SurfacePoint nearest = locator_.find_nearest(point);
  if (nearest.distance <= kFarthestFromSkin) return nearest;
  const Eigen::Vector3d normal = compute_normal(point, nearest.distance);
  const double depth = rays_.find_first(point, normal, kDeepestUnderSkin);
  if (!std::isfinite(depth)) return std::nullopt;
  SurfacePoint reached = locator_.find_nearest(point + depth * normal);
  reached.distance = depth;
  return reached;
}

}  // namespace lipofill::geometry
