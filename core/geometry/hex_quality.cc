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

namespace {

/// The smallest cosine between an edge of the deep face and its partner in the outer face. A column that runs through
/// the centre of a sphere comes out turned by half a circle, with good corners everywhere: this tells.
double compute_edge_agreement(const Eigen::Matrix<double, 3, 8>& x) {
  double smallest = 1.0;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d deep = (x.col((k + 1) % 4) - x.col(k)).normalized();
    const Eigen::Vector3d outer = (x.col(4 + (k + 1) % 4) - x.col(4 + k)).normalized();
    smallest = std::min(smallest, deep.dot(outer));
  }
  return smallest;
}

}  // namespace

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
        const double agreement = compute_edge_agreement(x);
        const double quality = agreement > 0.0 ? compute_scaled_jacobian(x) : agreement;
        if (quality >= worst.scaled_jacobian) continue;
        worst = {quality, level, x.rowwise().mean()};
      }
    }
  }
  return worst;
}

}  // namespace lipofill::geometry
