#include "core/geometry/grid_volume.h"

#include <Eigen/LU>
#include <cmath>

namespace lipofill::geometry {
namespace {

/// Column n is the corner with the signs of sign_of(n, 0), sign_of(n, 1), sign_of(n, 2).
using Corners = Eigen::Matrix<double, 3, 8>;

double sign_of(int corner, int axis) {
  return (corner >> axis) & 1 ? 1.0 : -1.0;
}

/// dx/dxi at a point of the reference cube [-1, 1]^3.
Eigen::Matrix3d jacobian_at(const Corners& corners, const Eigen::Vector3d& xi) {
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
  for (int n = 0; n < 8; ++n) {
    const double a = sign_of(n, 0), b = sign_of(n, 1), c = sign_of(n, 2);
    const Eigen::Vector3d gradient(a * (1 + b * xi[1]) * (1 + c * xi[2]), b * (1 + a * xi[0]) * (1 + c * xi[2]),
                                   c * (1 + a * xi[0]) * (1 + b * xi[1]));
    jacobian += corners.col(n) * gradient.transpose() / 8.0;
  }
  return jacobian;
}

double compute_volume(const Corners& corners) {
  const double g = 1.0 / std::sqrt(3.0);
  double volume = 0.0;
  for (int q = 0; q < 8; ++q) {
    const Eigen::Vector3d xi(g * sign_of(q, 0), g * sign_of(q, 1), g * sign_of(q, 2));
    volume += std::abs(jacobian_at(corners, xi).determinant());
  }
  return volume;
}

}  // namespace

double compute_grid_volume(const LayeredGrid& grid) {
  double volume = 0.0;
  for (int level = 0; level + 1 < grid.n_levels(); ++level) {
    for (int j = 0; j < grid.n_eta; ++j) {
      for (int i = 0; i < grid.n_xi; ++i) {
        Corners corners;
        for (int n = 0; n < 8; ++n) {
          corners.col(n) = grid.nodes.col(grid.node(level + ((n >> 2) & 1), i + (n & 1), j + ((n >> 1) & 1)));
        }
        volume += compute_volume(corners);
      }
    }
  }
  return volume;
}

}  // namespace lipofill::geometry
