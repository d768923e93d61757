#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace lipofill::solid {

using HexNodes = Eigen::Matrix<double, 3, 8>;        ///< node positions [m], nodes in the order of HexMesh
using HexStiffness = Eigen::Matrix<double, 24, 24>;  ///< degree of freedom 3 a + c: component c of node a
using LocalPoint = Eigen::Vector3d;                  ///< (xi, eta, zeta) in [-1, 1]^3

/// Local coordinates of the nodes (3, 8).
inline HexNodes hex_corners() {
  HexNodes corners;
  corners << -1, 1, 1, -1, -1, 1, 1, -1,  //
      -1, -1, 1, 1, -1, -1, 1, 1,         //
      -1, -1, -1, -1, 1, 1, 1, 1;
  return corners;
}

/// The 2 x 2 x 2 Gauss points, each of weight 1.
inline std::array<LocalPoint, 8> hex_gauss_points() {
  const HexNodes corners = hex_corners();
  std::array<LocalPoint, 8> points;
  for (int q = 0; q < 8; ++q) points[q] = corners.col(q) / std::sqrt(3.0);
  return points;
}

/// Trilinear shape functions N_a(point).
inline Eigen::Matrix<double, 8, 1> compute_shape(const LocalPoint& point) {
  const HexNodes corners = hex_corners();
  Eigen::Matrix<double, 8, 1> N;
  for (int a = 0; a < 8; ++a) N[a] = 0.125 * (1.0 + corners.col(a).cwiseProduct(point).array()).prod();
  return N;
}

/// Their derivatives dN_a/dxi_j, row a, column j.
inline Eigen::Matrix<double, 8, 3> compute_shape_derivatives(const LocalPoint& point) {
  const HexNodes corners = hex_corners();
  Eigen::Matrix<double, 8, 3> dN;
  for (int a = 0; a < 8; ++a) {
    const Eigen::Array3d factor = 1.0 + corners.col(a).cwiseProduct(point).array();
    for (int j = 0; j < 3; ++j) dN(a, j) = 0.125 * corners(j, a) * factor[(j + 1) % 3] * factor[(j + 2) % 3];
  }
  return dN;
}

/// J = dX/dxi, columns the covariant base vectors G_j.  [m]
inline Eigen::Matrix3d compute_jacobian(const HexNodes& nodes, const LocalPoint& point) {
  return nodes * compute_shape_derivatives(point);
}

}  // namespace lipofill::solid
