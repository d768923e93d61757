#include "server/wire/plan_check_conversion.h"

#include <algorithm>

#include "core/base/units.h"

namespace lipofill::server {
namespace {

constexpr size_t kMostFindings = 200;
/// A point takes some thirty bytes; a message has 4 MiB.
constexpr Eigen::Index kMostOutlinePoints = 20'000;

using Findings = google::protobuf::RepeatedPtrField<v1::PlanFinding>;

void add_findings(const std::vector<FieldViolation>& found, Findings& findings) {
  FieldViolations below_spec;
  for (size_t k = 0; k < std::min(found.size(), kMostFindings); ++k) {
    below_spec.absorb("spec", field_violation(found[k].field, found[k].description));
  }
  for (const FieldViolation& one : below_spec.all()) {
    v1::PlanFinding& finding = *findings.Add();
    finding.set_field(one.field);
    finding.set_description(one.description);
  }
}

void add_outline(const Eigen::Matrix3Xd& line, v1::PlacedZone& zone) {
  v1::SkinOutline& outline = *zone.add_outline();
  for (const auto& point : line.colwise()) {
    v1::Vector3& at = *outline.add_points_mm();
    at.set_x(kMillimetresPerMetre * point.x());
    at.set_y(kMillimetresPerMetre * point.y());
    at.set_z(kMillimetresPerMetre * point.z());
  }
}

Eigen::Index count_points(const simulation::PlacedZone& zone) {
  Eigen::Index n = 0;
  for (const Eigen::Matrix3Xd& line : zone.outline) n += line.cols();
  return n;
}

}  // namespace

v1::CheckPlanResponse to_check_plan_response(const simulation::PlanCheck& check) {
  v1::CheckPlanResponse response;
  add_findings(check.violations, *response.mutable_violations());
  add_findings(check.remarks, *response.mutable_remarks());
  Eigen::Index room = kMostOutlinePoints;
  for (const simulation::PlacedZone& placed : check.zones) {
    v1::PlacedZone& zone = *response.add_zones();
    zone.set_number(static_cast<uint32_t>(placed.number));
    zone.set_film(placed.film);
    zone.set_name(placed.name);
    zone.set_film_cells(static_cast<uint32_t>(placed.n_cells));
    zone.set_area_cm2(kSquareCentimetresPerSquareMetre * placed.area);
    const Eigen::Index n_points = count_points(placed);
    if (n_points > room) continue;
    room -= n_points;
    for (const Eigen::Matrix3Xd& line : placed.outline) add_outline(line, zone);
  }
  response.mutable_zone_under_skin_point()->Add(check.zone_under_skin.begin(), check.zone_under_skin.end());
  return response;
}

}  // namespace lipofill::server
