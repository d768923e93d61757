#include "core/planning/skin_matcher.h"

#include <cmath>

namespace lipofill::planning {

std::optional<SkinMatch> GridMatcher::match(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                            double reach) const {
  const int k = grid_.find(point);
  if (k < 0) return std::nullopt;
  const Eigen::Vector3d offset = point - samples_.points.col(k);
  const Eigen::Vector3d& n = samples_.normals.col(k);
  const double height = n.dot(offset);
  // Beyond the border the nearest sample lies far aside.
  const double aside = std::sqrt(std::max(0.0, offset.squaredNorm() - height * height));
  if (std::abs(height) > reach || aside > 2.0 * samples_.spacing + 0.5 * std::abs(height)) return std::nullopt;
  if (n.dot(normal) < kLeastAgreement) return std::nullopt;
  return SkinMatch{point - height * n, n, std::abs(height)};
}

std::optional<SkinMatch> ExactMatcher::match(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                             double reach) const {
  const geometry::SurfacePoint nearest = locator_.find_nearest(point);
  if (nearest.triangle < 0 || nearest.distance > reach || skin_.is_border[nearest.triangle]) return std::nullopt;
  const auto& corner = skin_.mesh.triangles[nearest.triangle];
  const Eigen::Vector3d b = geometry::compute_barycentric(skin_.mesh, nearest.triangle, nearest.position);
  const Eigen::Vector3d n =
      (b[0] * skin_.normals.col(corner[0]) + b[1] * skin_.normals.col(corner[1]) + b[2] * skin_.normals.col(corner[2]))
          .normalized();
  if (!(n.dot(normal) >= kLeastAgreement)) return std::nullopt;
  return SkinMatch{nearest.position, n, nearest.distance};
}

}  // namespace lipofill::planning
