#include "core/geometry/surface_chart.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/geometry/conformal_map.h"
#include "core/geometry/planar_locator.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

using Quadrilateral = std::array<Eigen::Vector2d, 4>;

constexpr char kCorners[] = "scan_region.corners";
constexpr double kSharpestCornerSine = 0.17;  // sine of 10 degrees
constexpr double kSliver = 1e-9;              // [m2] a triangle so small may turn over in the plane without harm

std::string in_mm(const Eigen::Vector3d& p) {
  return absl::StrFormat("(%.1f, %.1f, %.1f) mm", p.x() * 1e3, p.y() * 1e3, p.z() * 1e3);
}

int nearest_corner_vertex(const SurfaceMesh& mesh, const SurfacePoint& point) {
  int nearest = mesh.triangles[point.triangle][0];
  for (const int v : mesh.triangles[point.triangle]) {
    if ((mesh.points.col(v) - point.position).norm() < (mesh.points.col(nearest) - point.position).norm()) nearest = v;
  }
  return nearest;
}

Quadrilateral place_corners(const RegionPatch& patch, const Eigen::Matrix2Xd& flat) {
  Quadrilateral quad;
  for (size_t k = 0; k < quad.size(); ++k) {
    const auto& triangle = patch.mesh.triangles[patch.corners[k].triangle];
    const Eigen::Vector3d b = compute_barycentric(patch.mesh, patch.corners[k].triangle, patch.corners[k].position);
    quad[k] = b[0] * flat.col(triangle[0]) + b[1] * flat.col(triangle[1]) + b[2] * flat.col(triangle[2]);
  }
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
    return field_violation(kCorners, "run clockwise seen from outside; they must run anticlockwise");
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

bool contains(const Quadrilateral& quad, const Eigen::Vector2d& p) {
  for (size_t k = 0; k < 4; ++k) {
    if (compute_signed_area(quad[k], quad[(k + 1) % 4], p) < 0.0) return false;
  }
  return true;
}

/// The first triangle with a corner in the quadrilateral that the map turns over; -1 when there is
/// none.
int find_fold(const RegionPatch& patch, const Eigen::Matrix2Xd& flat, const Quadrilateral& quad) {
  for (int t = 0; t < patch.mesh.n_triangles(); ++t) {
    const auto& [a, b, c] = patch.mesh.triangles[t];
    if (compute_signed_area(flat.col(a), flat.col(b), flat.col(c)) > 0.0) continue;
    if (compute_area_vector(patch.mesh, patch.mesh.triangles[t]).norm() < kSliver) continue;
    if (contains(quad, flat.col(a)) || contains(quad, flat.col(b)) || contains(quad, flat.col(c))) return t;
  }
  return -1;
}

struct FlatRegion {
  Eigen::Matrix2Xd flat;
  Quadrilateral quad;
};

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
    fold = find_fold(patch, *flat, quad);
    if (fold < 0) return FlatRegion{std::move(*flat), quad};
  }
  return absl::FailedPreconditionError("the skin folds over itself inside the region near " +
                                       in_mm(patch.mesh.points.col(patch.mesh.triangles[fold][0])));
}

/// The points of the bilinear grid of the quadrilateral, brought back to the surface.
absl::StatusOr<Eigen::Matrix3Xd> sample_grid(const RegionPatch& patch, const FlatRegion& region, int n_xi, int n_eta) {
  const PlanarLocator locator(region.flat, patch.mesh.triangles);
  const Quadrilateral& q = region.quad;
  Eigen::Matrix3Xd points(3, (n_xi + 1) * (n_eta + 1));
  Eigen::Vector3d last = patch.corners[0].position;
  for (int j = 0; j <= n_eta; ++j) {
    for (int i = 0; i <= n_xi; ++i) {
      const double xi = static_cast<double>(i) / n_xi;
      const double eta = static_cast<double>(j) / n_eta;
      const Eigen::Vector2d p = (1 - eta) * ((1 - xi) * q[0] + xi * q[1]) + eta * ((1 - xi) * q[3] + xi * q[2]);
      const PlanarLocator::Place place = locator.find(p);
      if (place.triangle < 0) {
        return absl::FailedPreconditionError(absl::StrFormat(
            "the region runs over a border of the outer skin, or a hole wider than 15 mm, near %s (xi %.2f, eta %.2f)",
            in_mm(last), xi, eta));
      }
      const auto& [a, b, c] = patch.mesh.triangles[place.triangle];
      last = place.barycentric[0] * patch.mesh.points.col(a) + place.barycentric[1] * patch.mesh.points.col(b) +
             place.barycentric[2] * patch.mesh.points.col(c);
      points.col(j * (n_xi + 1) + i) = last;
    }
  }
  return points;
}

Quadrilateral enlarge(const Quadrilateral& quad, double factor) {
  const Eigen::Vector2d centre = 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]);
  Quadrilateral larger;
  for (size_t k = 0; k < 4; ++k) larger[k] = centre + factor * (quad[k] - centre);
  return larger;
}

}  // namespace

absl::StatusOr<RegionChart> chart_region(const RegionPatch& patch, int n_xi, int n_eta) {
  const auto region = flatten(patch);
  if (!region.ok()) return region.status();
  auto points = sample_grid(patch, *region, n_xi, n_eta);
  if (!points.ok()) return points.status();
  const Quadrilateral around = enlarge(region->quad, 1.0 + 2.0 / std::min(n_xi, n_eta));
  RegionChart chart{std::move(*points), {}};
  for (int v = 0; v < patch.mesh.n_vertices(); ++v)
    chart.is_vertex_near.push_back(contains(around, region->flat.col(v)));
  return chart;
}

}  // namespace lipofill::geometry
