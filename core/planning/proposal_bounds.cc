#include "core/planning/proposal_bounds.h"

#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"

namespace lipofill::planning {
namespace {

double in_ml(double volume) {
  return volume / kCubicMetresPerMillilitre;
}

/// Says what is wrong with a range of volumes; `field` has its upper end.
void check_range(const VolumeRange& range, const std::string& field, const std::string& of,
                 FieldViolations& violations) {
  if (range.low <= range.high) return;
  violations.add(field, absl::StrFormat("is %.3f mL, below the least volume of %s, %.3f mL", in_ml(range.high), of,
                                        in_ml(range.low)));
}

}  // namespace

absl::Status check_bounds(const ProposalBounds& bounds, const plan::SimulationSpec& plan, ZoneNumber number) {
  FieldViolations violations;
  std::set<std::string> names;
  double least = number == ZoneNumber::kFixed ? 0.0 : bounds.each_zone.low;
  for (const plan::FilmSpec& film : plan.films) {
    for (const plan::ZoneSpec& zone : film.zones) {
      names.insert(zone.name);
      if (number == ZoneNumber::kFixed) least += bounds.of(zone.name).low;
    }
  }
  check_range(bounds.each_zone, "bounds.max_zone_ml", "each zone", violations);
  for (const auto& [name, range] : bounds.zones) {
    const std::string field = absl::StrCat("bounds.zone_bounds[", name, "]");
    check_range(range, field, absl::StrCat("zone '", name, "'"), violations);
    if (!names.contains(name)) violations.add(field, "names no zone of the plan");
  }
  if (least > bounds.max_total) {
    violations.add("bounds.max_total_ml",
                   absl::StrFormat("is %.3f mL, and the least that the zones may take is %.3f mL",
                                   in_ml(bounds.max_total), in_ml(least)));
  }
  return violations.to_status();
}

}  // namespace lipofill::planning
