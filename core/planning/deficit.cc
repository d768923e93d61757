#include "core/planning/deficit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/anatomy/regions.h"
#include "core/base/units.h"
#include "core/geometry/surface_topology.h"
#include "core/planning/comparison.h"
#include "core/planning/face_part.h"
#include "core/planning/skin_surface.h"
#include "core/planning/symmetry_plane.h"

namespace lipofill::planning {
namespace {

constexpr double kRegionDepth = 0.030;  // [m]
constexpr double kBelowEverywhere = 0.01;

/// The skin that is compared: triangles of the scan's skin that are in the face and off the rim.
absl::StatusOr<std::vector<int>> find_compared(const SkinSurface& skin, const SkinSurface& target,
                                               const DeficitTask& task, const Unwanted& unwanted) {
  const auto rim = find_rim_points(skin.mesh.points, target.mesh, {skin.rim, target.rim, task.rim_width}, unwanted);
  if (!rim.ok()) return rim.status();
  std::vector<int> compared = find_triangles_without(skin.mesh, *rim);
  if (const auto ball = find_face_ball(task.landmarks)) {
    const std::vector<int> in_face = find_triangles_in(skin, *ball);
    std::erase_if(compared, [&](int t) { return !std::binary_search(in_face.begin(), in_face.end(), t); });
  }
  if (compared.empty()) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "no skin is left to compare: none is %s farther than %.1f mm from where scan and target end",
        task.landmarks.empty() ? "there" : "near the landmarks and", task.rim_width * kMillimetresPerMetre));
  }
  return compared;
}

/// The compared skin with its distances and volumes, from which parts are summed up.
struct Measured {
  geometry::SurfaceMesh mesh;
  std::vector<double> distances;                 ///< a value a vertex
  std::vector<geometry::VolumeBetween> volumes;  ///< a value a triangle
};

RegionDeficit sum_up(const Measured& measured, const std::vector<int>& triangles, std::string region) {
  RegionDeficit sum;
  sum.region = std::move(region);
  std::set<int> vertices;
  for (const int t : triangles) {
    const auto& corner = measured.mesh.triangles[t];
    sum.area += 0.5 * geometry::compute_area_vector(measured.mesh, corner).norm();
    sum.volume.deficit += measured.volumes[t].deficit;
    sum.volume.excess += measured.volumes[t].excess;
    vertices.insert(corner.begin(), corner.end());
  }
  std::vector<double> distances;
  for (const int v : vertices) {
    distances.push_back(measured.distances[v]);
    sum.max_deficit = std::max(sum.max_deficit, -measured.distances[v]);
  }
  sum.distance = geometry::compute_distance_statistics(distances);
  sum.vertices = static_cast<int>(vertices.size());
  return sum;
}

std::vector<int> find_region_triangles(const geometry::SurfaceMesh& mesh, const anatomy::PlacedRegion& region) {
  std::vector<int> inside;
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const auto& corner = mesh.triangles[t];
    const Eigen::Vector3d middle =
        (mesh.points.col(corner[0]) + mesh.points.col(corner[1]) + mesh.points.col(corner[2])) / 3.0;
    const Eigen::Vector3d normal = geometry::compute_area_vector(mesh, corner).normalized();
    if (std::abs(normal.dot(middle - region.centre)) > kRegionDepth) continue;
    if (region.compute_radius(middle, normal) <= 1.0) inside.push_back(t);
  }
  return inside;
}

std::vector<RegionDeficit> sum_up_regions(const Measured& measured, const geometry::Landmarks& landmarks) {
  std::vector<RegionDeficit> regions;
  const auto axes = geometry::estimate_head_axes(landmarks);
  if (!axes.ok()) return regions;
  for (const std::string& stem : anatomy::region_names()) {
    for (const char* side : {"_left", "_right"}) {
      const auto region = anatomy::place_region_by_landmarks(landmarks, *axes, stem + side);
      if (!region.ok()) continue;  // the landmarks that it needs are not there
      const std::vector<int> triangles = find_region_triangles(measured.mesh, *region);
      if (!triangles.empty()) regions.push_back(sum_up(measured, triangles, stem + side));
    }
  }
  std::sort(regions.begin(), regions.end(),
            [](const RegionDeficit& a, const RegionDeficit& b) { return a.region < b.region; });
  return regions;
}

void add_remarks(const DeficitTask& task, const SkinSurface& skin, const SkinSurface& target, Deficit& deficit) {
  if (target.was_inside_out != skin.was_inside_out) {
    deficit.remarks.push_back(absl::StrCat("the ", target.was_inside_out ? "target" : "scan",
                                           " was inside out, as mirrored surfaces are; it was turned"));
  }
  const auto& volume = deficit.all.volume;
  if (volume.excess > 0.0 && volume.deficit < kBelowEverywhere * volume.excess) {
    deficit.remarks.push_back(absl::StrFormat(
        "the target lies below the skin nearly everywhere: %.2f mL are missing and %.2f mL too much; fat only adds",
        volume.deficit / kCubicMetresPerMillilitre, volume.excess / kCubicMetresPerMillilitre));
  }
  if (deficit.regions.empty()) {
    deficit.remarks.push_back(task.landmarks.empty()
                                  ? "there are no figures by region, which need landmarks"
                                  : "there are no figures by region: landmarks for them are missing");
  }
}

}  // namespace

absl::StatusOr<Deficit> measure_deficit(const DeficitTask& task, const Unwanted& unwanted) {
  const auto skin = extract_skin(task.scan, "the scan");
  if (!skin.ok()) return skin.status();
  const auto target = extract_skin(task.target, "the target");
  if (!target.ok()) return target.status();
  const auto compared = find_compared(*skin, *target, task, unwanted);
  if (!compared.ok()) return compared.status();

  const geometry::SubSurface part = geometry::extract_triangles(skin->mesh, *compared);
  const auto distance = geometry::compute_patch_distance(part.mesh, target->mesh, unwanted);
  if (!distance.ok()) return distance.status();
  auto volumes = geometry::compute_volumes_between(part.mesh, target->mesh, unwanted);
  if (!volumes.ok()) return volumes.status();
  const Measured measured{part.mesh, distance->patch_to_target, *std::move(volumes)};

  Deficit deficit;
  std::vector<int> all(measured.mesh.triangles.size());
  for (size_t t = 0; t < all.size(); ++t) all[t] = static_cast<int>(t);
  deficit.all = sum_up(measured, all, "");
  deficit.regions = sum_up_regions(measured, task.landmarks);
  deficit.target_to_skin = distance->target_to_patch_statistics;
  deficit.hausdorff = std::max(deficit.all.distance.max, deficit.target_to_skin.max);
  deficit.distances.assign(static_cast<size_t>(task.scan.n_vertices()), std::numeric_limits<double>::quiet_NaN());
  for (int v = 0; v < part.mesh.n_vertices(); ++v) {
    deficit.distances[skin->scan_vertex[part.whole_of_vertex[v]]] = measured.distances[v];
  }
  if (!task.landmarks.empty()) {
    const auto plane = find_symmetry_plane(*skin, task.landmarks, unwanted);
    if (absl::IsCancelled(plane.status())) return plane.status();
    if (plane.ok()) deficit.symmetry_index = plane->index;
  }
  add_remarks(task, *skin, *target, deficit);
  return deficit;
}

}  // namespace lipofill::planning
