#include "core/geometry/hex_quality.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

namespace lipofill::geometry {

double compute_scaled_jacobian(const Eigen::Matrix<double, 3, 8>& x) {
  // For each corner the neighbours along xi, eta, zeta, and on which side of them it lies.
  constexpr std::array<std::array<int, 3>, 8> kNeighbours = {
      {{1, 3, 4}, {0, 2, 5}, {3, 1, 6}, {2, 0, 7}, {5, 7, 0}, {4, 6, 1}, {7, 5, 2}, {6, 4, 3}}};
  constexpr std::array<double, 8> kHandedness = {1, -1, 1, -1, -1, 1, -1, 1};
  double worst = 1.0;
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = (x.col(kNeighbours[corner][k]) - x.col(corner)).normalized();
    const double determinant = kHandedness[corner] * edges.determinant();
    worst = determinant < worst || determinant != determinant ? determinant : worst;
  }
  return worst;
}

WorstHexahedron find_worst_hexahedron(const LayeredGrid& grid) {
  WorstHexahedron worst;
  for (int level = 0; level + 1 < grid.n_levels(); ++level) {
    for (int j = 0; j < grid.n_eta; ++j) {
      for (int i = 0; i < grid.n_xi; ++i) {
        Eigen::Matrix<double, 3, 8> x;
        for (int face = 0; face < 2; ++face) {
          const int at = face == 0 ? level + 1 : level;
          x.col(4 * face + 0) = grid.nodes.col(grid.node(at, i, j));
          x.col(4 * face + 1) = grid.nodes.col(grid.node(at, i + 1, j));
          x.col(4 * face + 2) = grid.nodes.col(grid.node(at, i + 1, j + 1));
          x.col(4 * face + 3) = grid.nodes.col(grid.node(at, i, j + 1));
        }
        const double quality = compute_scaled_jacobian(x);
        if (quality >= worst.scaled_jacobian) continue;
        worst = {quality, level, x.rowwise().mean()};
      }
    }
  }
  return worst;
}

}  // namespace lipofill::geometry
