#include "core/geometry/surface_topology.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"

namespace lipofill::geometry {
namespace {

constexpr double kSmallestArea = 1e-12;  // [m2], a millionth of a square millimetre

}  // namespace

absl::Status check_indices(const char* field, const SurfaceMesh& mesh) {
  if (mesh.triangles.empty()) return field_violation(field, "has no triangle");
  if (!mesh.points.allFinite()) return field_violation(field, "has a vertex that is not finite");
  for (const auto& triangle : mesh.triangles) {
    for (const int v : triangle) {
      if (v >= 0 && v < mesh.n_vertices()) continue;
      return field_violation(field,
                             absl::StrCat("has a triangle of vertex ", v, ", must be in [0, ", mesh.n_vertices(), ")"));
    }
  }
  return absl::OkStatus();
}

namespace {

template <typename Visit>
void for_edge_uses(const SurfaceMesh& mesh, const Visit& visit) {
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
      visit(EdgeUse{low, high, t, k});
    }
  }
}

}  // namespace

// Uses are counted into place by their lower vertex; the few of one vertex are then sorted.
std::vector<EdgeUse> sort_edge_uses(const SurfaceMesh& mesh) {
  std::vector<size_t> end(static_cast<size_t>(mesh.n_vertices()) + 1, 0);
  for_edge_uses(mesh, [&](const EdgeUse& use) { ++end[use.low + 1]; });
  for (size_t v = 1; v < end.size(); ++v) end[v] += end[v - 1];
  std::vector<EdgeUse> uses(mesh.triangles.size() * 3);
  // Each count moves from the start of its vertex to the end.
  for_edge_uses(mesh, [&](const EdgeUse& use) { uses[end[use.low]++] = use; });
  size_t begin = 0;
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    std::sort(uses.begin() + static_cast<long>(begin), uses.begin() + static_cast<long>(end[v]),
              [](const EdgeUse& a, const EdgeUse& b) {
                return std::tie(a.high, a.triangle, a.side) < std::tie(b.high, b.triangle, b.side);
              });
    begin = end[v];
  }
  return uses;
}

TriangleNeighbours find_neighbours(const SurfaceMesh& mesh) {
  TriangleNeighbours result;
  result.across.assign(mesh.triangles.size(), {-1, -1, -1});
  const std::vector<EdgeUse> uses = sort_edge_uses(mesh);
  for (size_t begin = 0; begin < uses.size();) {
    size_t end = begin + 1;
    while (end < uses.size() && uses[end].low == uses[begin].low && uses[end].high == uses[begin].high) ++end;
    if (end - begin == 2) {
      result.across[uses[begin].triangle][uses[begin].side] = uses[begin + 1].triangle;
      result.across[uses[begin + 1].triangle][uses[begin + 1].side] = uses[begin].triangle;
    } else if (end - begin > 2) {
      ++result.non_manifold_edges;
    }
    begin = end;
  }
  return result;
}

Components label_components(const Across& across) {
  Components components;
  components.label.assign(across.size(), -1);
  std::vector<int> front;
  for (size_t seed = 0; seed < across.size(); ++seed) {
    if (components.label[seed] >= 0) continue;
    components.label[seed] = components.count;
    front.assign(1, static_cast<int>(seed));
    while (!front.empty()) {
      const int t = front.back();
      front.pop_back();
      for (const int neighbour : across[t]) {
        if (neighbour < 0 || components.label[neighbour] >= 0) continue;
        components.label[neighbour] = components.count;
        front.push_back(neighbour);
      }
    }
    ++components.count;
  }
  return components;
}

namespace {

int side_from(const std::array<int, 3>& triangle, int vertex) {
  for (int k = 0; k < 3; ++k) {
    if (triangle[k] == vertex) return k;
  }
  return -1;
}

/// The border side that starts where side (t, k) ends, reached by turning round that vertex; -1
/// where the turn does not come to a border, as beside an edge of triangles that disagree on their
/// direction.
std::pair<int, int> next_border_side(const SurfaceMesh& mesh, const Across& across, int t, int k) {
  const int pivot = mesh.triangles[t][(k + 1) % 3];
  int side = (k + 1) % 3;
  for (int turns = 0; turns <= mesh.n_triangles(); ++turns) {
    const int neighbour = across[t][side];
    if (neighbour < 0) return {t, side};
    t = neighbour;
    side = side_from(mesh.triangles[t], pivot);
    if (side < 0) break;
  }
  return {-1, -1};
}

}  // namespace

std::vector<std::vector<int>> trace_boundary_loops(const SurfaceMesh& mesh, const Across& across) {
  std::vector<std::array<bool, 3>> visited(mesh.triangles.size(), {false, false, false});
  std::vector<std::vector<int>> loops;
  for (int seed = 0; seed < mesh.n_triangles(); ++seed) {
    for (int k = 0; k < 3; ++k) {
      if (across[seed][k] >= 0 || visited[seed][k]) continue;
      std::vector<int> loop;
      for (std::pair<int, int> side = {seed, k}; side.first >= 0 && !visited[side.first][side.second];
           side = next_border_side(mesh, across, side.first, side.second)) {
        visited[side.first][side.second] = true;
        loop.push_back(mesh.triangles[side.first][side.second]);
      }
      loops.push_back(std::move(loop));
    }
  }
  return loops;
}

Eigen::Vector3d compute_area_vector(const SurfaceMesh& mesh, const std::array<int, 3>& triangle) {
  const Eigen::Vector3d a = mesh.points.col(triangle[0]);
  return (mesh.points.col(triangle[1]) - a).cross(mesh.points.col(triangle[2]) - a);
}

bool is_degenerate(const SurfaceMesh& mesh, const std::array<int, 3>& triangle) {
  if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) return true;
  return !(0.5 * compute_area_vector(mesh, triangle).norm() > kSmallestArea);
}

Eigen::Matrix3Xd compute_vertex_normals(const SurfaceMesh& mesh) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, mesh.n_vertices());
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d area_vector = compute_area_vector(mesh, triangle);
    const double twice_area = area_vector.norm();
    if (!(twice_area > 0.0)) continue;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = mesh.points.col(triangle[k]);
      const Eigen::Vector3d to_next = mesh.points.col(triangle[(k + 1) % 3]) - corner;
      const Eigen::Vector3d to_last = mesh.points.col(triangle[(k + 2) % 3]) - corner;
      normals.col(triangle[k]) += std::atan2(twice_area, to_next.dot(to_last)) / twice_area * area_vector;
    }
  }
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    const double length = normals.col(v).norm();
    if (length > 0.0) normals.col(v) /= length;
  }
  return normals;
}

SubSurface extract_triangles(const SurfaceMesh& mesh, const std::vector<int>& triangles) {
  SubSurface part;
  part.whole_of_triangle = triangles;
  part.vertex_of_whole.assign(mesh.n_vertices(), -1);
  for (const int t : triangles) {
    for (const int v : mesh.triangles[t]) part.vertex_of_whole[v] = 0;
  }
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    if (part.vertex_of_whole[v] < 0) continue;
    part.vertex_of_whole[v] = static_cast<int>(part.whole_of_vertex.size());
    part.whole_of_vertex.push_back(v);
  }
  part.mesh.points.resize(3, static_cast<Eigen::Index>(part.whole_of_vertex.size()));
  for (size_t v = 0; v < part.whole_of_vertex.size(); ++v)
    part.mesh.points.col(v) = mesh.points.col(part.whole_of_vertex[v]);
  part.mesh.triangles.reserve(triangles.size());
  for (const int t : triangles) {
    std::array<int, 3> corners = mesh.triangles[t];
    for (int& v : corners) v = part.vertex_of_whole[v];
    part.mesh.triangles.push_back(corners);
  }
  return part;
}

}  // namespace lipofill::geometry
