#include "core/planning/skin_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/geometry/outer_skin.h"
#include "core/geometry/ray_tree.h"
#include "core/geometry/surface_cleaning.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::planning {
namespace {

constexpr double kShortestRim = 0.2;  // [m]; an open mouth has 0.1 to 0.15

double compute_length(const geometry::SurfaceMesh& mesh, const std::vector<int>& loop) {
  double length = 0.0;
  for (size_t k = 0; k < loop.size(); ++k) {
    length += (mesh.points.col(loop[(k + 1) % loop.size()]) - mesh.points.col(loop[k])).norm();
  }
  return length;
}

std::vector<int> find_skin_triangles(const geometry::SurfaceMesh& mesh, const geometry::Across& across) {
  std::vector<int> all(static_cast<size_t>(mesh.n_triangles()));
  std::iota(all.begin(), all.end(), 0);
  const std::vector<bool> outer = geometry::find_outer_skin(mesh, across, geometry::RayTree(mesh), all);
  std::erase_if(all, [&](int t) { return !outer[static_cast<size_t>(t)]; });
  return all;
}

std::vector<bool> find_border_triangles(const geometry::SurfaceMesh& mesh) {
  std::vector<bool> border_vertex(static_cast<size_t>(mesh.n_vertices()), false);
  const geometry::Across across = geometry::find_neighbours(mesh).across;
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (across[t][k] >= 0) continue;
      border_vertex[mesh.triangles[t][k]] = border_vertex[mesh.triangles[t][(k + 1) % 3]] = true;
    }
  }
  std::vector<bool> border;
  for (const auto& t : mesh.triangles) {
    border.push_back(border_vertex[t[0]] || border_vertex[t[1]] || border_vertex[t[2]]);
  }
  return border;
}

}  // namespace

Eigen::Matrix3Xd find_rim(const geometry::SurfaceMesh& cleaned) {
  std::vector<int> vertices;
  for (const std::vector<int>& loop :
       geometry::trace_boundary_loops(cleaned, geometry::find_neighbours(cleaned).across)) {
    if (compute_length(cleaned, loop) >= kShortestRim) vertices.insert(vertices.end(), loop.begin(), loop.end());
  }
  return cleaned.points(Eigen::all, vertices);
}

SkinSurface extract_part(const SkinSurface& skin, const std::vector<int>& triangles) {
  geometry::SubSurface part = geometry::extract_triangles(skin.mesh, triangles);
  SkinSurface result;
  result.normals = skin.normals(Eigen::all, part.whole_of_vertex);
  result.rim = skin.rim;
  result.was_inside_out = skin.was_inside_out;
  for (const int v : part.whole_of_vertex) result.scan_vertex.push_back(skin.scan_vertex[v]);
  for (const int t : part.whole_of_triangle) result.is_border.push_back(skin.is_border[t]);
  for (const auto& t : part.mesh.triangles) result.area += 0.5 * geometry::compute_area_vector(part.mesh, t).norm();
  result.mesh = std::move(part.mesh);
  return result;
}

absl::StatusOr<SkinSurface> extract_skin(const geometry::SurfaceMesh& scan, const std::string& name) {
  geometry::CleanedSurface cleaned = geometry::clean_surface(scan);
  SkinSurface skin;
  if (cleaned.mesh.triangles.empty()) return absl::InvalidArgumentError(absl::StrCat(name, " has no surface"));
  skin.was_inside_out = geometry::is_inside_out(cleaned.mesh);
  if (skin.was_inside_out) {
    for (auto& triangle : cleaned.mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  const geometry::Across across = geometry::find_neighbours(cleaned.mesh).across;
  geometry::SubSurface outer = geometry::extract_triangles(cleaned.mesh, find_skin_triangles(cleaned.mesh, across));
  if (outer.mesh.triangles.empty()) return absl::InvalidArgumentError(absl::StrCat(name, " has no outer skin"));

  std::vector<int> scan_of_cleaned(static_cast<size_t>(cleaned.mesh.n_vertices()), -1);
  for (int v = scan.n_vertices() - 1; v >= 0; --v) {
    if (cleaned.vertex_of_scan[v] >= 0) scan_of_cleaned[cleaned.vertex_of_scan[v]] = v;
  }
  for (const int v : outer.whole_of_vertex) skin.scan_vertex.push_back(scan_of_cleaned[v]);
  skin.rim = find_rim(cleaned.mesh);
  for (const auto& t : outer.mesh.triangles) skin.area += 0.5 * geometry::compute_area_vector(outer.mesh, t).norm();
  skin.normals = geometry::compute_vertex_normals(outer.mesh);
  skin.is_border = find_border_triangles(outer.mesh);
  skin.mesh = std::move(outer.mesh);
  return skin;
}

}  // namespace lipofill::planning
