#include "core/model/region_footprints.h"

#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/anatomy/regions.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/geometry/scan_region.h"
#include "core/geometry/skin_projection.h"

namespace lipofill::model {
namespace {

constexpr char kAround[] = "scan_region.around";

}  // namespace

absl::StatusOr<std::vector<geometry::Footprint>> find_footprints(const geometry::ScanRegionSpec& scan,
                                                                 const AroundSpec& around) {
  FieldViolations violations;
  if (around.regions.empty() && around.discs.empty()) {
    violations.add(kAround, "names no region and no disc, of which at least 1 is needed");
  }
  violations.check_range(absl::StrCat(kAround, ".margin_mm"), around.margin * kMillimetresPerMetre, 2.0, 50.0, "mm");
  const auto axes = geometry::find_axes(scan);
  if (!axes.ok()) return axes.status();
  if (!axes->has_value() && !around.regions.empty()) return geometry::estimate_head_axes(scan.landmarks).status();
  const geometry::HeadAxes frame = axes->value_or(geometry::HeadAxes{});
  std::vector<geometry::Footprint> footprints;
  for (size_t k = 0; k < around.regions.size(); ++k) {
    const std::string field = absl::StrCat(kAround, ".regions[", k, "]");
    const auto placed = anatomy::place_region_by_landmarks(scan.landmarks, frame, around.regions[k]);
    violations.absorb(field, placed.status());
    if (!placed.ok()) continue;
    footprints.push_back(
        {around.regions[k], field, placed->centre, placed->along, placed->half_length, placed->half_width});
  }
  for (size_t k = 0; k < around.discs.size(); ++k) {
    const std::string field = absl::StrCat(kAround, ".discs[", k, "]");
    const double radius = around.discs[k].radius;
    violations.check_range(absl::StrCat(field, ".radius_mm"), radius * kMillimetresPerMetre, 2.0, 60.0, "mm");
    const auto centre = geometry::resolve_position(around.discs[k].centre, scan.landmarks, frame);
    violations.absorb(absl::StrCat(field, ".centre"), centre.status());
    if (!centre.ok()) continue;
    footprints.push_back({absl::StrCat("disc ", k), field, *centre, frame.up, radius, radius});
  }
  if (!violations.empty()) return violations.to_status();
  return footprints;
}

}  // namespace lipofill::model
