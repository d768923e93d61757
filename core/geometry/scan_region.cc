#include "core/geometry/scan_region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/geometry/outer_skin.h"
#include "core/geometry/skin_projection.h"
#include "core/geometry/surface_cleaning.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

constexpr double kShortestSide = 0.005;  // [m]
constexpr double kLongestSide = 0.300;   // [m]

absl::Status report(const Progress& progress, double fraction, const char* stage) {
  if (!progress || progress(fraction, stage)) return absl::OkStatus();
  return absl::CancelledError("building the geometry was cancelled");
}

absl::Status check_landmarks(const Landmarks& landmarks, const SurfaceLocator& locator) {
  FieldViolations violations;
  for (const auto& [name, position] : landmarks) {
    const std::string field = absl::StrCat("scan_region.landmarks_mm[\"", name, "\"]");
    if (!position.allFinite()) {
      violations.add(field, "is not a finite position");
      continue;
    }
    const double distance = locator.find_nearest(position).distance;
    if (distance <= kFarthestFromSkin) continue;
    violations.add(field, absl::StrFormat("lies %.1f mm from the surface of the scan, must be at most %.0f mm",
                                          distance * 1e3, kFarthestFromSkin * 1e3));
  }
  return violations.to_status();
}

bool needs_axes(const ScanRegionSpec& spec) {
  return std::any_of(spec.corners.begin(), spec.corners.end(), [](const SkinPoint& corner) {
    const auto* point = std::get_if<LandmarkPoint>(&corner);
    return point != nullptr && (point->left != 0.0 || point->up != 0.0 || point->forward != 0.0);
  });
}

/// The axes given, or estimated; those of the scan where neither is possible and no corner needs
/// them.
absl::StatusOr<HeadAxes> find_axes(const ScanRegionSpec& spec) {
  if (!spec.axes) {
    const auto estimated = estimate_head_axes(spec.landmarks);
    if (estimated.ok() || needs_axes(spec)) return estimated;
    return HeadAxes{};
  }
  Eigen::Matrix3d frame;
  frame << spec.axes->left, spec.axes->up, spec.axes->forward;
  constexpr double kTolerance = 0.02;
  const double error = (frame.transpose() * frame - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kTolerance) || !(spec.axes->up.cross(spec.axes->forward).dot(spec.axes->left) > 0.0)) {
    return field_violation("scan_region.axes",
                           "are not three unit vectors at right angles with left = up x forward (to 0.02)");
  }
  return *spec.axes;
}

absl::StatusOr<std::array<Eigen::Vector3d, 4>> resolve_corners(const ScanRegionSpec& spec, const HeadAxes& axes) {
  std::array<Eigen::Vector3d, 4> positions;
  FieldViolations violations;
  for (size_t k = 0; k < 4; ++k) {
    const auto position = resolve_position(spec.corners[k], spec.landmarks, axes);
    violations.absorb(absl::StrCat("scan_region.corners[", k, "]"), position.status());
    if (position.ok()) positions[k] = *position;
  }
  const absl::Status status = violations.to_status();
  if (!status.ok()) return status;
  return positions;
}

absl::Status check_sides(const std::array<Eigen::Vector3d, 4>& corners) {
  FieldViolations violations;
  for (size_t k = 0; k < 4; ++k) {
    const double side = (corners[(k + 1) % 4] - corners[k]).norm();
    if (side >= kShortestSide && side <= kLongestSide) continue;
    violations.add("scan_region.corners",
                   absl::StrFormat("make a side of %.1f mm from corner %d to %d, must be in [%.0f, %.0f] mm",
                                   side * 1e3, k, (k + 1) % 4, kShortestSide * 1e3, kLongestSide * 1e3));
  }
  return violations.to_status();
}

/// Triangles within reach of the region: more than the patch will need.
std::vector<int> find_candidates(const SurfaceMesh& mesh, const std::array<Eigen::Vector3d, 4>& corners) {
  const Eigen::Vector3d centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  double radius = 0.0;
  for (const Eigen::Vector3d& corner : corners) radius = std::max(radius, (corner - centre).norm());
  radius = 2.0 * radius + 0.02;
  std::vector<int> candidates;
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const bool near = std::any_of(triangle.begin(), triangle.end(),
                                  [&](int v) { return (mesh.points.col(v) - centre).norm() <= radius; });
    if (near) candidates.push_back(t);
  }
  return candidates;
}

std::string explain_off_skin(double to_skin, double to_scan) {
  if (to_scan <= kFarthestFromSkin) {
    return absl::StrFormat(
        "lies on an inner surface of the scan, %.1f mm from the outer skin; must be at most %.0f mm from the outer "
        "skin",
        to_skin * 1e3, kFarthestFromSkin * 1e3);
  }
  return absl::StrFormat("lies %.1f mm from the outer skin, must be at most %.0f mm", to_skin * 1e3,
                         kFarthestFromSkin * 1e3);
}

/// Moves the corners onto the outer skin.
absl::StatusOr<std::array<SurfacePoint, 4>> project_corners(const SurfaceMesh& skin,
                                                            const SurfaceLocator& whole_locator,
                                                            const std::array<Eigen::Vector3d, 4>& positions) {
  const SurfaceLocator locator(skin);
  std::array<SurfacePoint, 4> corners;
  FieldViolations violations;
  for (size_t k = 0; k < 4; ++k) {
    corners[k] = locator.find_nearest(positions[k]);
    if (corners[k].distance <= kFarthestFromSkin) continue;
    violations.add(absl::StrCat("scan_region.corners[", k, "]"),
                   explain_off_skin(corners[k].distance, whole_locator.find_nearest(positions[k]).distance));
  }
  const absl::Status status = violations.to_status();
  if (!status.ok()) return status;
  return corners;
}

void turn_right_side_out(SurfaceMesh& mesh, std::vector<std::string>& remarks) {
  if (!is_inside_out(mesh)) return;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  remarks.push_back("The surface was inside out and has been turned.");
}

/// The triangles of outer skin near the corners as a surface of their own.
absl::StatusOr<SubSurface> extract_outer_skin(const SurfaceMesh& mesh, const RayTree& rays,
                                              const std::array<Eigen::Vector3d, 4>& corners) {
  const std::vector<int> candidates = find_candidates(mesh, corners);
  const std::vector<bool> outer = find_outer_skin(mesh, find_neighbours(mesh).across, rays, candidates);
  std::vector<int> skin;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(skin), [&](int t) { return outer[t]; });
  if (skin.empty()) return field_violation("scan_region.corners", "have no outer skin of the scan near them");
  return extract_triangles(mesh, skin);
}

}  // namespace

absl::StatusOr<ScanRegion> find_scan_region(const ScanRegionSpec& spec, const Progress& progress) {
  const absl::Status valid = check_indices("scan_region.scan", spec.scan);
  if (!valid.ok()) return valid;
  if (const absl::Status go = report(progress, 0.0, "cleaning the scan"); !go.ok()) return go;
  CleanedSurface cleaned = clean_surface(spec.scan);
  if (cleaned.mesh.triangles.empty()) return absl::FailedPreconditionError("cleaning leaves no triangle of the scan");
  const SurfaceLocator locator(cleaned.mesh);
  turn_right_side_out(cleaned.mesh, cleaned.remarks);

  const absl::Status landmarks = check_landmarks(spec.landmarks, locator);
  if (!landmarks.ok()) return landmarks;
  const auto axes = find_axes(spec);
  if (!axes.ok()) return axes.status();
  const auto positions = resolve_corners(spec, *axes);
  if (!positions.ok()) return positions.status();
  const absl::Status sides = check_sides(*positions);
  if (!sides.ok()) return sides;

  if (const absl::Status go = report(progress, 0.2, "finding the outer skin"); !go.ok()) return go;
  const auto skin = extract_outer_skin(cleaned.mesh, RayTree(cleaned.mesh), *positions);
  if (!skin.ok()) return skin.status();
  const auto corners = project_corners(skin->mesh, locator, *positions);
  if (!corners.ok()) return corners.status();

  if (const absl::Status go = report(progress, 0.5, "cutting the region"); !go.ok()) return go;
  auto patch = cut_region_patch(skin->mesh, *corners);
  if (!patch.ok()) return patch.status();
  for (int& v : patch->whole_of_vertex) v = v < 0 ? -1 : skin->whole_of_vertex[v];
  ScanRegion region{std::move(*patch), *axes, std::move(cleaned.vertex_of_scan), std::move(cleaned.remarks)};
  region.remarks.insert(region.remarks.end(), region.patch.remarks.begin(), region.patch.remarks.end());
  return region;
}

}  // namespace lipofill::geometry
