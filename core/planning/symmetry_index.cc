#include "core/planning/symmetry_index.h"

#include <cmath>

#include "core/geometry/surface_topology.h"
#include "core/planning/comparison.h"
#include "core/planning/skin_matcher.h"

namespace lipofill::planning {

double measure_symmetry_index(const geometry::SurfaceMesh& part, const SkinSurface& face, const Reflection& plane) {
  constexpr double kReach = 0.010;  // [m]
  const ExactMatcher matcher(face);
  const Eigen::Matrix3Xd normals = geometry::compute_vertex_normals(part);
  double squares = 0.0, n = 0.0;
  for (int v = 0; v < part.n_vertices(); ++v) {
    // As far as the point from the image of the face is the image of the point from the face.
    const auto match = matcher.match(plane.apply(part.points.col(v)), plane.turn(normals.col(v)), kReach);
    if (match) squares += match->distance * match->distance, n += 1.0;
  }
  return n > 0.0 ? std::sqrt(squares / n) : 0.0;
}

geometry::SurfaceMesh lay_onto(const geometry::SurfaceMesh& part, const SkinSurface& face) {
  constexpr double kReach = 0.030;  // [m]
  const ExactMatcher matcher(face);
  const Eigen::Matrix3Xd normals = geometry::compute_vertex_normals(part);
  geometry::SurfaceMesh laid = part;
  std::vector<bool> has_no_place(static_cast<size_t>(part.n_vertices()), true);
  for (int v = 0; v < part.n_vertices(); ++v) {
    const auto match = matcher.match(part.points.col(v), normals.col(v), kReach);
    if (!match) continue;
    laid.points.col(v) = match->position;
    has_no_place[static_cast<size_t>(v)] = false;
  }
  return geometry::extract_triangles(laid, find_triangles_without(laid, has_no_place)).mesh;
}

}  // namespace lipofill::planning
