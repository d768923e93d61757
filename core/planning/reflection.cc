#include "core/planning/reflection.h"

#include <utility>

namespace lipofill::planning {

geometry::SurfaceMesh reflect(geometry::SurfaceMesh mesh, const Reflection& reflection) {
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    const Eigen::Vector3d point = mesh.points.col(v);
    mesh.points.col(v) = reflection.apply(point);
  }
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

SkinSurface reflect(SkinSurface skin, const Reflection& reflection) {
  skin.mesh = reflect(std::move(skin.mesh), reflection);
  for (Eigen::Index v = 0; v < skin.normals.cols(); ++v) {
    const Eigen::Vector3d normal = skin.normals.col(v);
    skin.normals.col(v) = reflection.turn(normal);
  }
  return skin;
}

}  // namespace lipofill::planning
