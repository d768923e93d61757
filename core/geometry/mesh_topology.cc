#include "core/geometry/mesh_topology.h"

#include "core/base/units.h"

namespace lipofill::geometry {
namespace {

template <typename Visit>
void for_each_column(const LayeredGrid& grid, Visit&& visit) {
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) visit(i, j);
  }
}

void add_quadrilateral(const LayeredGrid& grid, int level, int i, int j, std::vector<uint32_t>& cells) {
  for (const int node : {grid.node(level, i, j), grid.node(level, i + 1, j), grid.node(level, i + 1, j + 1),
                         grid.node(level, i, j + 1)}) {
    cells.push_back(static_cast<uint32_t>(node));
  }
}

}  // namespace

std::vector<double> to_points_mm(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  std::vector<double> values;
  values.reserve(static_cast<size_t>(points.size()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    for (int c = 0; c < 3; ++c) values.push_back(kMillimetresPerMetre * points(c, i));
  }
  return values;
}

MeshTopology make_skin_mesh(const LayeredGrid& grid) {
  MeshTopology mesh{"skin", to_points_mm(grid.nodes.leftCols(grid.nodes_per_level())), {}, 4};
  for_each_column(grid, [&](int i, int j) { add_quadrilateral(grid, 0, i, j, mesh.cells); });
  return mesh;
}

MeshTopology make_scan_mesh(const SurfaceMesh& scan) {
  MeshTopology mesh{"scan", to_points_mm(scan.points), {}, 3};
  for (const auto& triangle : scan.triangles) {
    for (const int vertex : triangle) mesh.cells.push_back(static_cast<uint32_t>(vertex));
  }
  return mesh;
}

MeshTopology make_tissue_mesh(const LayeredGrid& grid) {
  MeshTopology mesh{"tissue", to_points_mm(grid.nodes), {}, 8};
  for (int level = 0; level + 1 < grid.n_levels(); ++level) {
    for_each_column(grid, [&](int i, int j) {
      for (const int l : {level + 1, level}) add_quadrilateral(grid, l, i, j, mesh.cells);
    });
  }
  return mesh;
}

std::vector<MeshTopology> make_model_meshes(const FaceGeometry& geometry) {
  std::vector<MeshTopology> meshes = {make_skin_mesh(geometry.grid)};
  if (geometry.scan.n_vertices() > 0) meshes.push_back(make_scan_mesh(geometry.scan));
  if (geometry.grid.n_layers() > 0) meshes.push_back(make_tissue_mesh(geometry.grid));
  return meshes;
}

}  // namespace lipofill::geometry
