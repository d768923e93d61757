#pragma once

#include <Eigen/Core>
#include <memory>

#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

struct SurfacePoint {
  int triangle = -1;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  double distance = 0.0;                               ///< the point asked about is this far away [m]
};

/// Nearest points on a surface, through VTK. The surface must have a triangle. Of triangles at the
/// same distance it is the same one that is found every time. Checked by
/// tests/unit/geometry/surface_locator_test.cc.
class SurfaceLocator {
 public:
  explicit SurfaceLocator(const SurfaceMesh& mesh);
  ~SurfaceLocator();
  SurfaceLocator(const SurfaceLocator&) = delete;
  SurfaceLocator& operator=(const SurfaceLocator&) = delete;

  SurfacePoint find_nearest(const Eigen::Vector3d& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Barycentric coordinates of a point in the plane of a triangle.
Eigen::Vector3d compute_barycentric(const SurfaceMesh& mesh, int triangle, const Eigen::Vector3d& position);

}  // namespace lipofill::geometry
