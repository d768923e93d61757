#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace lipofill::geometry {

/// A triangulated surface in the scan's own frame, in metres. Vertices are in the order of the file
/// they came from.
struct SurfaceMesh {
  Eigen::Matrix3Xd points;                    ///< [m]  (3, n_vertices)
  std::vector<std::array<int, 3>> triangles;  ///< anticlockwise seen from outside

  int n_vertices() const { return static_cast<int>(points.cols()); }
  int n_triangles() const { return static_cast<int>(triangles.size()); }
};

}  // namespace lipofill::geometry
