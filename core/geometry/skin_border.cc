#include "core/geometry/skin_border.h"

#include <Eigen/Geometry>

namespace lipofill::geometry {
namespace {

constexpr double kOnBorder = 1e-6;  // of a barycentric coordinate
constexpr double kAside = 0.5e-3;   // [m]

std::vector<bool> flag_border_vertices(const SurfaceMesh& mesh, const Across& across) {
  std::vector<bool> is_border(mesh.n_vertices(), false);
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    for (int side = 0; side < 3; ++side) {
      if (across[t][side] >= 0) continue;
      is_border[mesh.triangles[t][side]] = true;
      is_border[mesh.triangles[t][(side + 1) % 3]] = true;
    }
  }
  return is_border;
}

}  // namespace

std::vector<bool> find_border_vertices(const SurfaceMesh& mesh) {
  return flag_border_vertices(mesh, find_neighbours(mesh).across);
}

BorderFinder::BorderFinder(const SurfaceMesh& surface)
    : surface_(surface),
      across_(find_neighbours(surface).across),
      is_border_vertex_(flag_border_vertices(surface, across_)) {}

bool BorderFinder::is_beyond(const Eigen::Vector3d& point, const SurfacePoint& nearest) const {
  if (!is_on_border(nearest)) return false;
  const Eigen::Vector3d normal = compute_area_vector(surface_, surface_.triangles[nearest.triangle]).normalized();
  const Eigen::Vector3d gap = point - nearest.position;
  return (gap - gap.dot(normal) * normal).norm() > kAside;
}

bool BorderFinder::is_on_border(const SurfacePoint& place) const {
  const Eigen::Vector3d weights = compute_barycentric(surface_, place.triangle, place.position);
  for (int k = 0; k < 3; ++k) {
    if (weights[k] >= 1.0 - kOnBorder && is_border_vertex_[surface_.triangles[place.triangle][k]]) return true;
    // Side k runs from corner k to the next: the third corner has no weight on it.
    if (weights[(k + 2) % 3] <= kOnBorder && across_[place.triangle][k] < 0) return true;
  }
  return false;
}

}  // namespace lipofill::geometry
