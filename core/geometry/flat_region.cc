#include "core/geometry/flat_region.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "core/geometry/planar_locator.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

constexpr double kSliver = 1e-9;  // [m2] a triangle so small may turn over in the plane without harm

absl::StatusOr<Eigen::Matrix3Xd> sample_grid(const SurfaceMesh& mesh, const FlatRegion& region, int n_xi, int n_eta) {
  const PlanarLocator locator(region.flat, mesh.triangles);
  const Quadrilateral& q = region.quad;
  Eigen::Matrix3Xd points(3, (n_xi + 1) * (n_eta + 1));
  Eigen::Vector3d last = mesh.points.col(mesh.triangles.front()[0]);
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
      const auto& [a, b, c] = mesh.triangles[place.triangle];
      last = place.barycentric[0] * mesh.points.col(a) + place.barycentric[1] * mesh.points.col(b) +
             place.barycentric[2] * mesh.points.col(c);
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

std::string in_mm(const Eigen::Vector3d& position) {
  return absl::StrFormat("(%.1f, %.1f, %.1f) mm", position.x() * 1e3, position.y() * 1e3, position.z() * 1e3);
}

Eigen::Vector2d place_in_plane(const SurfaceMesh& mesh, const Eigen::Matrix2Xd& flat, const SurfacePoint& point) {
  const auto& triangle = mesh.triangles[point.triangle];
  const Eigen::Vector3d b = compute_barycentric(mesh, point.triangle, point.position);
  return b[0] * flat.col(triangle[0]) + b[1] * flat.col(triangle[1]) + b[2] * flat.col(triangle[2]);
}

bool contains(const Quadrilateral& quad, const Eigen::Vector2d& p) {
  for (size_t k = 0; k < 4; ++k) {
    if (compute_signed_area(quad[k], quad[(k + 1) % 4], p) < 0.0) return false;
  }
  return true;
}

int find_fold(const SurfaceMesh& mesh, const Eigen::Matrix2Xd& flat, const Quadrilateral& quad) {
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (compute_signed_area(flat.col(a), flat.col(b), flat.col(c)) > 0.0) continue;
    if (compute_area_vector(mesh, mesh.triangles[t]).norm() < kSliver) continue;
    if (contains(quad, flat.col(a)) || contains(quad, flat.col(b)) || contains(quad, flat.col(c))) return t;
  }
  return -1;
}

absl::Status describe_fold(const SurfaceMesh& mesh, int triangle) {
  return absl::FailedPreconditionError("the skin folds over itself inside the region near " +
                                       in_mm(mesh.points.col(mesh.triangles[triangle][0])));
}

absl::StatusOr<RegionChart> sample_chart(const SurfaceMesh& mesh, const FlatRegion& region, int n_xi, int n_eta) {
  auto points = sample_grid(mesh, region, n_xi, n_eta);
  if (!points.ok()) return points.status();
  const Quadrilateral around = enlarge(region.quad, 1.0 + 2.0 / std::min(n_xi, n_eta));
  RegionChart chart{std::move(*points), {}};
  for (int v = 0; v < mesh.n_vertices(); ++v) chart.is_vertex_near.push_back(contains(around, region.flat.col(v)));
  return chart;
}

}  // namespace lipofill::geometry
