#include "core/plan/zone_share.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "absl/strings/str_format.h"
#include "core/geometry/footprint.h"
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

/// The ellipse of skin that a zone asks for, where it asks for one.
std::optional<anatomy::PlacedRegion> find_ellipse(const geometry::FaceGeometry& face, const ZoneSpec& zone) {
  if (const auto* named = std::get_if<NamedRegion>(&zone.shape)) {
    const auto placed = anatomy::place_region(face, named->name);
    return placed.ok() ? std::optional(*placed) : std::nullopt;
  }
  const auto* disc = std::get_if<Disc>(&zone.shape);
  if (disc == nullptr) return std::nullopt;
  const auto centre = geometry::locate_in_chart(face, disc->centre);
  if (!centre.ok()) return std::nullopt;
  return anatomy::PlacedRegion{geometry::skin_position(face.grid, *centre), face.axes.up, disc->radius, disc->radius};
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

void judge_zone_share(const model::FaceModel& model, const FilmSpec& spec, const ZoneSpec& zone,
                      const std::string& field, FieldViolations& violations, std::vector<std::string>& remarks) {
  if (model.is_square) return;
  const auto ellipse = find_ellipse(model.geometry, zone);
  if (!ellipse) return;
  const double share = compute_zone_share(model.geometry, *ellipse, spec.extent);
  if (share < geometry::kSmallestZoneShare) {
    violations.add(field,
                   absl::StrFormat("'%s' lies on the model with %.2f of its area, must be at least %.1f: make the "
                                   "model's region larger or move it, or the zone smaller",
                                   zone.name, share, geometry::kSmallestZoneShare));
  } else if (share < geometry::kWholeZoneShare) {
    remarks.push_back(absl::StrFormat("Zone %s lies on the model with %.2f of its area.", zone.name, share));
  }
}

}  // namespace lipofill::plan
