#include "core/geometry/scan_region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/geometry/landmark_checks.h"
#include "core/geometry/outer_skin.h"
#include "core/geometry/skin_border.h"
#include "core/geometry/skin_projection.h"
#include "core/geometry/skin_reach.h"
#include "core/geometry/surface_cleaning.h"
#include "core/geometry/surface_topology.h"
#include "core/geometry/zone_patch.h"

namespace lipofill::geometry {
namespace {

constexpr double kShortestSide = 0.005;  // [m]
constexpr double kLongestSide = 0.300;   // [m]
constexpr double kFarCorner = 0.005;     // [m] a corner that moves farther is remarked upon

absl::Status report(const Progress& progress, double fraction, const char* stage) {
  if (!progress || progress(fraction, stage)) return absl::OkStatus();
  return absl::CancelledError("building the geometry was cancelled");
}

bool needs_axes(const ScanRegionSpec& spec) {
  if (!spec.footprints.empty()) return false;
  return std::any_of(spec.corners.begin(), spec.corners.end(), [](const SkinPoint& corner) {
    const auto* point = std::get_if<LandmarkPoint>(&corner);
    return point != nullptr && (point->left != 0.0 || point->up != 0.0 || point->forward != 0.0);
  });
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

/// The ball around the corners, larger than the patch will need.
Ball find_ball(const std::array<Eigen::Vector3d, 4>& corners) {
  Ball ball{0.25 * (corners[0] + corners[1] + corners[2] + corners[3])};
  for (const Eigen::Vector3d& corner : corners) ball.radius = std::max(ball.radius, (corner - ball.centre).norm());
  ball.radius = 2.0 * ball.radius + 0.02;
  return ball;
}

std::string explain_off_skin(double to_skin, double to_scan, bool is_beyond) {
  // Beyond a border the skin is what is nearest of the scan.
  const bool is_inside = to_scan < 0.5 * to_skin;
  if (is_beyond && !is_inside) {
    return absl::StrFormat(
        "lies %.1f mm beyond a border of the skin, must be at most %.0f mm from it: the scan ends there", to_skin * 1e3,
        kFarthestFromSkin * 1e3);
  }
  if (to_scan <= kFarthestFromSkin) {
    return absl::StrFormat(
        "lies on an inner surface of the scan, %.1f mm from the outer skin; must be at most %.0f mm from the outer "
        "skin",
        to_skin * 1e3, kFarthestFromSkin * 1e3);
  }
  return absl::StrFormat("lies %.1f mm from the outer skin, must be at most %.0f mm", to_skin * 1e3,
                         kFarthestFromSkin * 1e3);
}

/// Moves the corners onto the outer skin: those given by landmarks along the outward normal, where
/// they lie deep.
absl::StatusOr<std::array<SurfacePoint, 4>> project_corners(const SurfaceMesh& skin, const ScanRegionSpec& spec,
                                                            const SurfaceLocator& whole_locator,
                                                            const std::array<Eigen::Vector3d, 4>& positions,
                                                            std::vector<std::string>& cautions) {
  const SkinReach reach(skin);
  const BorderFinder borders(skin);
  std::array<SurfacePoint, 4> corners;
  FieldViolations violations;
  for (size_t k = 0; k < 4; ++k) {
    corners[k] = reach.find_nearest(positions[k]);
    const bool is_beyond = borders.is_beyond(positions[k], corners[k]);
    std::optional<SurfacePoint> reached = corners[k];
    if (corners[k].distance > kFarthestFromSkin) {
      const bool may_be_deep = std::holds_alternative<LandmarkPoint>(spec.corners[k]);
      reached = may_be_deep ? reach.reach(positions[k]) : std::nullopt;
    }
    if (!reached) {
      violations.add(
          absl::StrCat("scan_region.corners[", k, "]"),
          explain_off_skin(corners[k].distance, whole_locator.find_nearest(positions[k]).distance, is_beyond));
      continue;
    }
    corners[k] = *reached;
    if (corners[k].distance <= kFarCorner) continue;
    cautions.push_back(absl::StrFormat("scan_region.corners[%d] lay %.1f mm from the skin and was moved onto it.", k,
                                       corners[k].distance * 1e3));
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

/// This is what the steps of finding a region share.
struct Cleaned {
  CleanedSurface surface;
  HeadAxes axes;
};

absl::StatusOr<RegionPatch> find_patch_between_corners(const ScanRegionSpec& spec, const Cleaned& scan,
                                                       const SurfaceLocator& locator, const Progress& progress,
                                                       std::vector<std::string>& cautions) {
  const auto positions = resolve_corners(spec, scan.axes);
  if (!positions.ok()) return positions.status();
  const absl::Status sides = check_sides(*positions);
  if (!sides.ok()) return sides;
  const SurfaceMesh& mesh = scan.surface.mesh;
  const SubSurface skin = extract_outer_skin(mesh, find_ball(*positions));
  if (skin.mesh.triangles.empty()) {
    return field_violation("scan_region.corners", "have no outer skin of the scan near them");
  }
  const auto corners = project_corners(skin.mesh, spec, locator, *positions, cautions);
  if (!corners.ok()) return corners.status();
  if (const absl::Status go = report(progress, 0.5, "cutting the region"); !go.ok()) return go;
  auto patch = cut_region_patch(skin.mesh, *corners);
  if (!patch.ok()) return patch.status();
  for (int& v : patch->whole_of_vertex) v = v < 0 ? -1 : skin.whole_of_vertex[v];
  return patch;
}

}  // namespace

absl::StatusOr<std::optional<HeadAxes>> find_axes(const ScanRegionSpec& spec) {
  if (!spec.axes) {
    const auto estimated = estimate_head_axes(spec.landmarks);
    if (estimated.ok()) return *estimated;
    if (needs_axes(spec)) return estimated.status();
    return std::nullopt;
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

absl::StatusOr<ScanRegion> find_scan_region(const ScanRegionSpec& spec, const Progress& progress) {
  const absl::Status valid = check_indices("scan_region.scan", spec.scan);
  if (!valid.ok()) return valid;
  if (const absl::Status go = report(progress, 0.0, "cleaning the scan"); !go.ok()) return go;
  Cleaned scan{clean_surface(spec.scan), {}};
  SurfaceMesh& mesh = scan.surface.mesh;
  if (mesh.triangles.empty()) return absl::FailedPreconditionError("cleaning leaves no triangle of the scan");
  const SurfaceLocator locator(mesh);
  turn_right_side_out(mesh, scan.surface.remarks);

  if (const absl::Status finite = check_finite(spec.landmarks); !finite.ok()) return finite;
  const auto axes = find_axes(spec);
  if (!axes.ok()) return axes.status();
  scan.axes = axes->value_or(HeadAxes{});
  ScanRegion region;
  const absl::Status landmarks =
      check_landmarks(spec.landmarks, axes->has_value() ? &scan.axes : nullptr, mesh, locator, region.cautions);
  if (!landmarks.ok()) return landmarks;

  if (const absl::Status go = report(progress, 0.2, "finding the outer skin"); !go.ok()) return go;
  if (!spec.footprints.empty()) region.around.emplace();
  auto patch = region.around ? find_patch_around(spec, scan.surface.mesh, scan.axes, progress, *region.around)
                             : find_patch_between_corners(spec, scan, locator, progress, region.cautions);
  if (!patch.ok()) return patch.status();
  region.patch = *std::move(patch);
  region.axes = scan.axes;
  region.cleaned_of_scan = std::move(scan.surface.vertex_of_scan);
  region.remarks = std::move(scan.surface.remarks);
  region.remarks.insert(region.remarks.end(), region.patch.remarks.begin(), region.patch.remarks.end());
  return region;
}

}  // namespace lipofill::geometry
