#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/face_geometry.h"

namespace lipofill::geometry {

/// A mesh whose points move: what viewers draw. `kind` 3: triangles, 4: quadrilaterals, 8:
/// hexahedra.
struct MeshTopology {
  std::string name;               ///< "skin", "scan", "film/<name>", "tissue"
  std::vector<double> points_mm;  ///< (n_points, 3) at rest
  std::vector<uint32_t> cells;    ///< (n_cells, kind)
  int kind = 3;
  int n_points() const { return static_cast<int>(points_mm.size() / 3); }
  int n_cells() const { return static_cast<int>(cells.size()) / kind; }
};

/// Positions in metres as points of a mesh, in double precision: a scan may lie hundreds of
/// kilometres from the origin.
std::vector<double> to_points_mm(const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// "skin": the nodes of level 0 and the quadrilaterals between them, anticlockwise seen from
/// outside.
MeshTopology make_skin_mesh(const LayeredGrid& grid);
/// "scan": vertices and triangles as they were given.
MeshTopology make_scan_mesh(const SurfaceMesh& scan);
/// "tissue": all hexahedra, not split by any film, in the order of solid::HexMesh: the deep face
/// first.
MeshTopology make_tissue_mesh(const LayeredGrid& grid);

/// The meshes of a model at rest: "skin", then "scan" and "tissue" where it has them.
/// Checked by tests/unit/geometry/mesh_topology_test.cc.
std::vector<MeshTopology> make_model_meshes(const FaceGeometry& geometry);

}  // namespace lipofill::geometry
