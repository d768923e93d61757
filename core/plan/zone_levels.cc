#include "core/plan/zone_levels.h"

#include "absl/strings/str_cat.h"
#include "core/anatomy/regions.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"

namespace lipofill::plan {
namespace {

using geometry::ChartPoint;
using geometry::Level;
using Levels = std::vector<Level>;

absl::StatusOr<Levels> levels_of(const geometry::FaceGeometry&, const ChartBox& box) {
  FieldViolations violations;
  check_box(box, "box", violations);
  if (!violations.empty()) return violations.to_status();
  return Levels{[low = box.xi_min](const ChartPoint& p) { return p.xi - low; },
                [high = box.xi_max](const ChartPoint& p) { return high - p.xi; },
                [low = box.eta_min](const ChartPoint& p) { return p.eta - low; },
                [high = box.eta_max](const ChartPoint& p) { return high - p.eta; }};
}

absl::StatusOr<Levels> levels_of(const geometry::FaceGeometry& face, const Disc& disc) {
  FieldViolations violations;
  violations.check_range("disc.radius_mm", disc.radius / kMetresPerMillimetre, 0.1, 500.0, "mm");
  const auto centre = geometry::locate_in_chart(face, disc.centre);
  violations.absorb("disc.centre", centre.status());
  if (!violations.empty()) return violations.to_status();
  return Levels{[&face, at = geometry::skin_position(face.grid, *centre), radius = disc.radius](const ChartPoint& p) {
    return radius - (geometry::skin_position(face.grid, p) - at).norm();
  }};
}

absl::StatusOr<Levels> levels_of(const geometry::FaceGeometry&, const PaintedRegion& painted) {
  FieldViolations violations;
  violations.absorb("painted", painted.cover.validate());
  if (!violations.empty()) return violations.to_status();
  return Levels{[cover = painted.cover](const ChartPoint& p) { return cover.at(p.xi, p.eta) - 0.5; }};
}

absl::StatusOr<Levels> levels_of(const geometry::FaceGeometry& face, const NamedRegion& region) {
  const auto placed = anatomy::place_region(face, region.name);
  if (!placed.ok()) {
    FieldViolations violations;
    violations.absorb("region", placed.status());
    return violations.to_status();
  }
  return Levels{
      [&face, placed = *placed](const ChartPoint& p) { return placed.level(geometry::skin_position(face.grid, p)); }};
}

}  // namespace

absl::StatusOr<std::vector<Level>> make_zone_levels(const geometry::FaceGeometry& face, const ZoneSpec& zone) {
  return std::visit([&](const auto& shape) { return levels_of(face, shape); }, zone.shape);
}

void check_box(const ChartBox& box, const std::string& field, FieldViolations& violations) {
  violations.check_range(field + ".xi_min", box.xi_min, 0.0, 1.0, "");
  violations.check_range(field + ".xi_max", box.xi_max, 0.0, 1.0, "");
  violations.check_range(field + ".eta_min", box.eta_min, 0.0, 1.0, "");
  violations.check_range(field + ".eta_max", box.eta_max, 0.0, 1.0, "");
  if (!(box.xi_min < box.xi_max))
    violations.add(field + ".xi_max", absl::StrCat("is ", box.xi_max, ", must be above xi_min ", box.xi_min));
  if (!(box.eta_min < box.eta_max))
    violations.add(field + ".eta_max", absl::StrCat("is ", box.eta_max, ", must be above eta_min ", box.eta_min));
}

}  // namespace lipofill::plan
