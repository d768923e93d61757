#pragma once

#include <array>
#include <vector>

#include "absl/status/status.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// Checks a surface. INVALID_ARGUMENT with a violation of `field` when it has no triangles, a
/// position that is not finite or a triangle of a vertex that is not there.
absl::Status check_indices(const char* field, const SurfaceMesh& mesh);

/// One side of a triangle: side k runs from corner k to corner k + 1. `low` < `high` are its
/// vertices.
struct EdgeUse {
  int low = 0;
  int high = 0;
  int triangle = 0;
  int side = 0;
};

/// All sides of all triangles, those of one edge next to each other, ordered by (low, high,
/// triangle, side).
std::vector<EdgeUse> sort_edge_uses(const SurfaceMesh& mesh);

/// The triangle across each side of each triangle; -1 at a border and at an edge of more than two
/// triangles.
using Across = std::vector<std::array<int, 3>>;

struct TriangleNeighbours {
  Across across;
  int non_manifold_edges = 0;
};

TriangleNeighbours find_neighbours(const SurfaceMesh& mesh);

/// Parts of a surface joined through edges, numbered in the order of their first triangle.
struct Components {
  std::vector<int> label;  ///< a number a triangle
  int count = 0;
};

Components label_components(const Across& across);

/// Closed chains of border edges, each as its vertices in the direction of the triangles beside it.
/// At a vertex where several borders meet each border is followed round its own fan of triangles.
std::vector<std::vector<int>> trace_boundary_loops(const SurfaceMesh& mesh, const Across& across);

/// True for repeated corners, or an area that rounding could have made.
bool is_degenerate(const SurfaceMesh& mesh, const std::array<int, 3>& triangle);

/// Twice the area times the outward normal [m2].
Eigen::Vector3d compute_area_vector(const SurfaceMesh& mesh, const std::array<int, 3>& triangle);

/// Normals of the vertices, weighted by the angles of the triangles around them; zero where no
/// triangle is.
Eigen::Matrix3Xd compute_vertex_normals(const SurfaceMesh& mesh);

/// The part of `mesh` made of `triangles` (ascending), its vertices renumbered in their old order.
struct SubSurface {
  SurfaceMesh mesh;
  std::vector<int> vertex_of_whole;    ///< a number a vertex of the whole, -1 where left out
  std::vector<int> whole_of_vertex;    ///< a number a vertex of the part
  std::vector<int> whole_of_triangle;  ///< a number a triangle of the part
};

SubSurface extract_triangles(const SurfaceMesh& mesh, const std::vector<int>& triangles);

}  // namespace lipofill::geometry
