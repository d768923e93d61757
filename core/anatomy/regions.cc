#include "core/anatomy/regions.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/anatomy/sided_names.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/geometry/skin_projection.h"

namespace lipofill::anatomy {
namespace {

struct RegionRow {
  const char* name;
  std::vector<std::pair<const char*, double>> weights;  ///< without their side
  double outward_mm;                                    ///< the centre lies this far towards its side of the face
  double up_mm;
  double forward_mm;
  const char* axis_from;
  const char* axis_to;
  double half_length_mm;
  double half_width_mm;
};

/// Regions on the skin over the structure each is named after; sizes are assumed.
const std::vector<RegionRow>& rows() {
  static const std::vector<RegionRow> table = {
      {"masseter", {{"zygion", 0.50}, {"gonion", 0.40}, {"cheilion", 0.10}}, 0, 0, 0, "gonion", "zygion", 30, 23},
      {"mandibular_angle", {{"gonion", 0.80}, {"cheilion", 0.20}}, 0, 0, 0, "gonion", "cheilion", 34, 20},
      {"buccal", {{"cheilion", 0.58}, {"zygion", 0.24}, {"gonion", 0.18}}, 10, 0, 8, "cheilion", "zygion", 18, 16},
      {"malar", {{"zygion", 0.45}, {"exocanthion", 0.35}, {"cheilion", 0.20}}, 0, 0, 0, "zygion", "cheilion", 22, 14},
      {"temple", {{"zygion", 0.5}, {"exocanthion", 0.5}}, 0, 18, -8, "zygion", "exocanthion", 18, 16},
      {"nasolabial", {{"cheilion", 0.6}, {"exocanthion", 0.4}}, 0, 0, 0, "cheilion", "exocanthion", 20, 8},
      {"chin", {{"pogonion", 0.7}, {"cheilion", 0.3}}, 0, 0, 0, "pogonion", "cheilion", 16, 12},
  };
  return table;
}

}  // namespace

std::vector<std::string> region_names() {
  std::vector<std::string> names;
  for (const RegionRow& row : rows()) names.emplace_back(row.name);
  return names;
}

absl::StatusOr<Region> find_region(std::string_view name) {
  if (const auto parts = split_side(name)) {
    const auto [stem, side] = *parts;
    for (const RegionRow& row : rows()) {
      if (stem != row.name) continue;
      Region region;
      for (const auto& [landmark, weight] : row.weights) region.centre.weights[with_side(landmark, side)] = weight;
      region.centre.left = (side == "left" ? row.outward_mm : -row.outward_mm) * kMetresPerMillimetre;
      region.centre.up = row.up_mm * kMetresPerMillimetre;
      region.centre.forward = row.forward_mm * kMetresPerMillimetre;
      region.axis_from = with_side(row.axis_from, side);
      region.axis_to = with_side(row.axis_to, side);
      region.half_length = row.half_length_mm * kMetresPerMillimetre;
      region.half_width = row.half_width_mm * kMetresPerMillimetre;
      return region;
    }
  }
  return field_violation("", absl::StrCat("is '", std::string(name), "', must be one of ",
                                          absl::StrJoin(region_names(), ", "), " followed by _left or _right"));
}

bool PlacedRegion::contains(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d offset = point - centre;
  const double length = offset.dot(along);
  const double width = (offset - length * along).norm();
  const double a = length / half_length;
  const double b = width / half_width;
  return a * a + b * b <= 1.0;
}

double PlacedRegion::compute_radius(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  Eigen::Vector3d offset = point - centre;
  offset -= offset.dot(normal) * normal;
  const double length = offset.dot(along);
  const double width = (offset - length * along).norm();
  return std::hypot(length / half_length, width / half_width);
}

absl::StatusOr<PlacedRegion> place_region_by_landmarks(const geometry::FaceGeometry& face, std::string_view name) {
  const auto region = find_region(name);
  if (!region.ok()) return region.status();
  for (const std::string& landmark : {region->axis_from, region->axis_to}) {
    if (!face.landmarks.contains(landmark)) {
      return field_violation("", absl::StrCat("is '", std::string(name), "', which needs the landmark ", landmark));
    }
  }
  const auto centre = geometry::resolve_position(region->centre, face.landmarks, face.axes);
  if (!centre.ok()) return centre.status();
  PlacedRegion placed;
  placed.centre = *centre;
  placed.along = (face.landmarks.at(region->axis_to) - face.landmarks.at(region->axis_from)).normalized();
  placed.half_length = region->half_length;
  placed.half_width = region->half_width;
  return placed;
}

absl::StatusOr<PlacedRegion> place_region(const geometry::FaceGeometry& face, std::string_view name) {
  const auto region = find_region(name);
  if (!region.ok()) return region.status();
  const auto centre = geometry::locate_in_chart(face, region->centre);
  if (!centre.ok()) return centre.status();
  auto placed = place_region_by_landmarks(face, name);
  if (placed.ok()) placed->centre = geometry::skin_position(face.grid, *centre);
  return placed;
}

}  // namespace lipofill::anatomy
