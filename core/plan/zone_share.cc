#include "core/plan/zone_share.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/skin_projection.h"

namespace lipofill::plan {
namespace {

constexpr int kRings = 8;
constexpr int kAngles = 24;
constexpr double kNormalStep = 0.01;  // of the chart
constexpr double kRoundOff = 1e-9;

Eigen::Vector3d compute_normal(const geometry::LayeredGrid& grid, const geometry::ChartPoint& at) {
  const auto slope = [&](double xi, double eta) -> Eigen::Vector3d {
    return geometry::skin_position(grid, {at.xi + xi, at.eta + eta}) -
           geometry::skin_position(grid, {at.xi - xi, at.eta - eta});
  };
  return slope(kNormalStep, 0.0).cross(slope(0.0, kNormalStep)).normalized();
}

bool holds(const geometry::ChartBox& box, const geometry::ChartPoint& p) {
  return p.xi >= box.xi_min - kRoundOff && p.xi <= box.xi_max + kRoundOff && p.eta >= box.eta_min - kRoundOff &&
         p.eta <= box.eta_max + kRoundOff;
}

}  // namespace

double compute_zone_share(const geometry::FaceGeometry& face, const anatomy::PlacedRegion& region,
                          const geometry::ChartBox& box) {
  const geometry::SkinProjection projection(face.grid);
  const Eigen::Vector3d normal = compute_normal(face.grid, projection.project(region.centre).place);
  const Eigen::Vector3d along = (region.along - region.along.dot(normal) * normal).normalized();
  const Eigen::Vector3d across = normal.cross(along);
  int held = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double radius = std::sqrt((ring + 0.5) / kRings);
    for (int k = 0; k < kAngles; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.5 * (ring % 2)) / kAngles;
      const Eigen::Vector3d point = region.centre + radius * (region.half_length * std::cos(angle) * along +
                                                              region.half_width * std::sin(angle) * across);
      held += holds(box, projection.project(point).place);
    }
  }
  return static_cast<double>(held) / (kRings * kAngles);
}

}  // namespace lipofill::plan
