#include "core/anatomy/regions.h"

#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/anatomy/sided_names.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/geometry/head_size.h"
#include "core/geometry/skin_projection.h"

namespace lipofill::anatomy {
namespace {

struct RegionRow {
  const char* name;
  std::vector<std::pair<const char*, double>> weights;  ///< without their side
  double outward_mm;                                    ///< the centre lies this far towards its side of the face
  double up_mm;
  double forward_mm;
  const char* axis_from;  ///< empty: across the face
  const char* axis_to;
  double half_length_mm;
  double half_width_mm;
};

/// Regions on the skin over the structure each is named after, on a head of average size; places
/// and sizes are assumed. Means of landmarks lie inside the face; the skin is found from there
/// along the outward normal.
const std::vector<RegionRow>& rows() {
  static const std::vector<RegionRow> table = {
      {"masseter", {{"zygion", 0.50}, {"gonion", 0.40}, {"cheilion", 0.10}}, 0, 0, 0, "gonion", "zygion", 30, 23},
      {"mandibular_angle", {{"gonion", 0.80}, {"cheilion", 0.20}}, 0, 0, 0, "gonion", "cheilion", 34, 20},
      {"buccal", {{"cheilion", 0.58}, {"zygion", 0.24}, {"gonion", 0.18}}, 10, 0, 8, "cheilion", "zygion", 18, 16},
      {"malar", {{"zygion", 0.45}, {"exocanthion", 0.35}, {"cheilion", 0.20}}, 0, 0, 0, "zygion", "cheilion", 22, 14},
      {"zygomatic",
       {{"zygion", 0.50}, {"exocanthion", 0.40}, {"cheilion", 0.10}},
       0,
       0,
       0,
       "zygion",
       "exocanthion",
       18,
       9},
      {"soof", {{"exocanthion", 0.60}, {"cheilion", 0.25}, {"zygion", 0.15}}, 0, 0, 0, "nasion", "zygion", 11, 6},
      {"tear_trough",
       {{"exocanthion", 0.40}, {"nasion", 0.35}, {"cheilion", 0.25}},
       0,
       0,
       0,
       "nasion",
       "zygion",
       11,
       5},
      {"midface",
       {{"exocanthion", 0.35}, {"cheilion", 0.45}, {"subnasale", 0.20}},
       4,
       0,
       0,
       "cheilion",
       "exocanthion",
       13,
       10},
      {"nasolabial",
       {{"cheilion", 0.60}, {"subnasale", 0.25}, {"exocanthion", 0.15}},
       2,
       0,
       0,
       "cheilion",
       "nasion",
       15,
       6},
      {"upper_lip", {{"subnasale", 0.55}, {"cheilion", 0.45}}, 0, 0, 0, "subnasale", "cheilion", 11, 5},
      {"lower_lip", {{"cheilion", 0.60}, {"pogonion", 0.40}}, 0, 0, 0, "", "", 10, 5},
      {"marionette", {{"cheilion", 0.62}, {"pogonion", 0.20}, {"gonion", 0.18}}, 0, 0, 0, "menton", "cheilion", 12, 6},
      {"chin", {{"pogonion", 0.70}, {"cheilion", 0.30}}, 0, 0, 0, "pogonion", "cheilion", 16, 12},
      {"jawline", {{"gonion", 0.45}, {"menton", 0.25}, {"cheilion", 0.30}}, 9, 0, 2, "gonion", "menton", 22, 9},
      {"submaxillary", {{"gonion", 0.45}, {"menton", 0.20}, {"cheilion", 0.35}}, 7, -10, 0, "gonion", "menton", 20, 11},
      {"temple", {{"zygion", 0.25}, {"exocanthion", 0.75}}, 0, 19, 2, "zygion", "exocanthion", 14, 12},
      {"forehead", {{"exocanthion", 0.60}, {"nasion", 0.40}}, 0, 28, 0, "", "", 18, 11},
  };
  return table;
}

/// All landmarks that a region needs, each once.
std::set<std::string> landmarks_of(const Region& region) {
  std::set<std::string> names;
  for (const auto& [landmark, weight] : region.centre.weights) names.insert(landmark);
  for (const std::string& landmark : {region.axis_from, region.axis_to}) {
    if (!landmark.empty()) names.insert(landmark);
  }
  return names;
}

/// The region on a head of that size: offsets and half-axes grow with it.
Region scale_region(Region region, double scale) {
  for (double* length :
       {&region.centre.left, &region.centre.up, &region.centre.forward, &region.half_length, &region.half_width}) {
    *length *= scale;
  }
  return region;
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
      if (*row.axis_from != '\0') region.axis_from = with_side(row.axis_from, side);
      if (*row.axis_to != '\0') region.axis_to = with_side(row.axis_to, side);
      region.half_length = row.half_length_mm * kMetresPerMillimetre;
      region.half_width = row.half_width_mm * kMetresPerMillimetre;
      return region;
    }
  }
  return field_violation("", absl::StrCat("is '", std::string(name), "', must be one of ",
                                          absl::StrJoin(region_names(), ", "), " followed by _left or _right"));
}

double PlacedRegion::level(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d offset = point - centre;
  const double length = offset.dot(along);
  const double width = (offset - length * along).norm();
  return 1.0 - std::hypot(length / half_length, width / half_width);
}

double PlacedRegion::compute_radius(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  Eigen::Vector3d offset = point - centre;
  offset -= offset.dot(normal) * normal;
  const double length = offset.dot(along);
  const double width = (offset - length * along).norm();
  return std::hypot(length / half_length, width / half_width);
}

absl::StatusOr<PlacedRegion> place_region_by_landmarks(const geometry::Landmarks& landmarks,
                                                       const geometry::HeadAxes& axes, std::string_view name) {
  const auto average = find_region(name);
  if (!average.ok()) return average.status();
  const Region region = scale_region(*average, geometry::compute_head_scale(landmarks).value_or(1.0));
  std::vector<std::string> missing;
  for (const std::string& landmark : landmarks_of(region)) {
    if (!landmarks.contains(landmark)) missing.push_back(landmark);
  }
  if (!missing.empty()) {
    return field_violation(
        "", absl::StrCat("is '", std::string(name), "', which needs the ",
                         missing.size() == 1 ? "landmark " : "landmarks ", absl::StrJoin(missing, ", ")));
  }
  const auto centre = geometry::resolve_position(region.centre, landmarks, axes);
  if (!centre.ok()) return centre.status();
  PlacedRegion placed;
  placed.centre = *centre;
  placed.along = region.axis_from.empty()
                     ? axes.left
                     : (landmarks.at(region.axis_to) - landmarks.at(region.axis_from)).normalized();
  placed.half_length = region.half_length;
  placed.half_width = region.half_width;
  return placed;
}

absl::StatusOr<PlacedRegion> place_region_by_landmarks(const geometry::FaceGeometry& face, std::string_view name) {
  return place_region_by_landmarks(face.landmarks, face.axes, name);
}

absl::StatusOr<PlacedRegion> place_region(const geometry::FaceGeometry& face, std::string_view name) {
  auto placed = place_region_by_landmarks(face, name);
  if (!placed.ok()) return placed.status();
  const Region region = scale_region(*find_region(name), geometry::compute_head_scale(face.landmarks).value_or(1.0));
  const auto centre = geometry::locate_in_chart(face, region.centre);
  if (!centre.ok()) return centre.status();
  placed->centre = geometry::skin_position(face.grid, *centre);
  return placed;
}

}  // namespace lipofill::anatomy
