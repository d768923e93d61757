#include "core/plan/zone_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/face_geometry.h"

namespace lipofill::plan {
namespace {

double squared_distance(const Eigen::Vector3d& point, const std::array<Eigen::Vector3d, 2>& segment) {
  const Eigen::Vector3d along = segment[1] - segment[0];
  const double length = along.squaredNorm();
  const double share = length > 0.0 ? std::clamp((point - segment[0]).dot(along) / length, 0.0, 1.0) : 0.0;
  return (point - segment[0] - share * along).squaredNorm();
}

}  // namespace

ZoneDistance::ZoneDistance(const geometry::LayeredGrid& grid, const geometry::Level& level) {
  for (const geometry::OutlineSegment& segment : geometry::trace_outline(level, 2 * grid.n_xi, 2 * grid.n_eta)) {
    segments_.push_back({geometry::skin_position(grid, segment[0]), geometry::skin_position(grid, segment[1])});
  }
  for (const auto& segment : segments_) centre_ += segment[0] / static_cast<double>(segments_.size());
  for (const auto& segment : segments_) {
    for (const Eigen::Vector3d& end : segment) radius_ = std::max(radius_, (end - centre_).norm());
  }
}

double ZoneDistance::to_outline(const Eigen::Vector3d& point, double reach) const {
  double nearest = std::numeric_limits<double>::infinity();
  if (segments_.empty() || (point - centre_).norm() > radius_ + reach) return nearest;
  for (const auto& segment : segments_) nearest = std::min(nearest, squared_distance(point, segment));
  nearest = std::sqrt(nearest);
  return nearest <= reach ? nearest : std::numeric_limits<double>::infinity();
}

}  // namespace lipofill::plan
