#include "core/geometry/footprint_samples.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/geometry/skin_border.h"

namespace lipofill::geometry {
namespace {

constexpr int kRings = 8;
constexpr int kAnglesOfRing = 24;
constexpr int kAnglesOfRim = 96;

}  // namespace

std::vector<FootprintSample> sample_footprint(const SurfaceMesh& skin, const SkinReach& reach,
                                              const Footprint& footprint) {
  const Eigen::Vector3d normal = reach.compute_normal(footprint.centre, footprint.half_width);
  const Eigen::Vector3d along = (footprint.along - footprint.along.dot(normal) * normal).normalized();
  const Eigen::Vector3d across = normal.cross(along);
  const BorderFinder borders(skin);
  std::vector<FootprintSample> samples;
  const auto add = [&](double radius, double angle, bool is_outline) {
    const Eigen::Vector3d point = footprint.centre + radius * (footprint.half_length * std::cos(angle) * along +
                                                               footprint.half_width * std::sin(angle) * across);
    const SurfacePoint nearest = reach.find_nearest(point);
    samples.push_back({nearest, borders.is_beyond(point, nearest), is_outline});
  };
  for (int k = 0; k < kAnglesOfRim; ++k) add(1.0, 2.0 * std::numbers::pi * k / kAnglesOfRim, true);
  for (int ring = 0; ring < kRings; ++ring) {
    const double radius = std::sqrt((ring + 0.5) / kRings);
    for (int k = 0; k < kAnglesOfRing; ++k)
      add(radius, 2.0 * std::numbers::pi * (k + 0.5 * (ring % 2)) / kAnglesOfRing, false);
  }
  return samples;
}

}  // namespace lipofill::geometry
