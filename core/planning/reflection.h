#pragma once

#include <Eigen/Core>

#include "core/geometry/surface_mesh.h"
#include "core/planning/skin_surface.h"

namespace lipofill::planning {

/// The reflection at the plane n . x = d: x -> x - 2 (n . x - d) n.
struct Reflection {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< unit
  double offset = 0.0;                                ///< d [m]

  double height(const Eigen::Vector3d& point) const { return normal.dot(point) - offset; }
  Eigen::Vector3d apply(const Eigen::Vector3d& point) const { return point - 2.0 * height(point) * normal; }
  Eigen::Vector3d turn(const Eigen::Vector3d& direction) const {
    return direction - 2.0 * normal.dot(direction) * normal;
  }
};

/// The mirror image, its triangles turned so that they look outwards again.
geometry::SurfaceMesh reflect(geometry::SurfaceMesh mesh, const Reflection& reflection);
SkinSurface reflect(SkinSurface skin, const Reflection& reflection);

}  // namespace lipofill::planning
