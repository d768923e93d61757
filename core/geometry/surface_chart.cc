#include "core/geometry/surface_chart.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/geometry/conformal_map.h"
#include "core/geometry/flat_region.h"
#include "core/geometry/planar_locator.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

constexpr char kCorners[] = "scan_region.corners";
constexpr double kSharpestCornerSine = 0.17;  // sine of 10 degrees

int nearest_corner_vertex(const SurfaceMesh& mesh, const SurfacePoint& point) {
  int nearest = mesh.triangles[point.triangle][0];
  for (const int v : mesh.triangles[point.triangle]) {
    if ((mesh.points.col(v) - point.position).norm() < (mesh.points.col(nearest) - point.position).norm()) nearest = v;
  }
  return nearest;
}

Quadrilateral place_corners(const RegionPatch& patch, const Eigen::Matrix2Xd& flat) {
  Quadrilateral quad;
  for (size_t k = 0; k < quad.size(); ++k) quad[k] = place_in_plane(patch.mesh, flat, patch.corners[k]);
  return quad;
}

bool segments_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  return compute_signed_area(a, b, c) * compute_signed_area(a, b, d) < 0.0 &&
         compute_signed_area(c, d, a) * compute_signed_area(c, d, b) < 0.0;
}

absl::Status check_quadrilateral(const Quadrilateral& q) {
  if (segments_cross(q[0], q[1], q[2], q[3]) || segments_cross(q[1], q[2], q[3], q[0])) {
    return field_violation(kCorners, "make sides that cross; they must go round the region in order");
  }
  if (compute_signed_area(q[0], q[1], q[2]) + compute_signed_area(q[0], q[2], q[3]) < 0.0) {
    return field_violation(kCorners,
                           "run clockwise seen from outside; they must run anticlockwise (corners taken over from the "
                           "other side of a face run the other way round)");
  }
  for (size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d to_next = (q[(k + 1) % 4] - q[k]).normalized();
    const Eigen::Vector2d to_last = (q[(k + 3) % 4] - q[k]).normalized();
    const double sine = to_next.x() * to_last.y() - to_next.y() * to_last.x();
    if (sine >= kSharpestCornerSine) continue;
    return field_violation(
        absl::StrFormat("%s[%d]", kCorners, k),
        absl::StrFormat("has an angle of %.0f degrees in the flattened skin, must be in [10, 170]: the "
                        "quadrilateral must be convex",
                        std::fmod(std::atan2(sine, to_next.dot(to_last)) * 57.29578 + 360.0, 360.0)));
  }
  return absl::OkStatus();
}

/// The conformal map, or where it folds the region the map with mean-value weights.
absl::StatusOr<FlatRegion> flatten(const RegionPatch& patch) {
  const int pin_a = nearest_corner_vertex(patch.mesh, patch.corners[0]);
  const int pin_b = nearest_corner_vertex(patch.mesh, patch.corners[2]);
  if (pin_a == pin_b) return field_violation(kCorners, "lie in one facet of the scan; the region is too small for it");
  int fold = -1;
  for (const bool conformal : {true, false}) {
    auto flat = conformal ? compute_conformal_map(patch.mesh, pin_a, pin_b) : compute_harmonic_map(patch.mesh);
    if (!flat.ok()) return flat.status();
    const Quadrilateral quad = place_corners(patch, *flat);
    const absl::Status proper = check_quadrilateral(quad);
    if (!proper.ok()) return proper;
    fold = find_fold(patch.mesh, *flat, quad);
    if (fold < 0) return FlatRegion{std::move(*flat), quad};
  }
  return describe_fold(patch.mesh, fold);
}

}  // namespace

absl::StatusOr<RegionChart> chart_region(const RegionPatch& patch, int n_xi, int n_eta) {
  const auto region = flatten(patch);
  if (!region.ok()) return region.status();
  return sample_chart(patch.mesh, *region, n_xi, n_eta);
}

}  // namespace lipofill::geometry
