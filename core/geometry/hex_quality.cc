#include "core/geometry/hex_quality.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lipofill::geometry {

namespace {

/// The neighbours of each corner, so ordered that a positively oriented element has a positive
/// determinant.
constexpr int kNeighbours[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                   {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};

double normalised_determinant(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double product = a.squaredNorm() * b.squaredNorm() * c.squaredNorm();
  if (!(product > 0.0) || !std::isfinite(product)) return -1.0;
  return a.cross(b).dot(c) / std::sqrt(product);
}

}  // namespace

double compute_scaled_jacobian(const Eigen::Matrix<double, 3, 8>& nodes) {
  const Eigen::Vector3d xi = nodes.col(1) + nodes.col(2) + nodes.col(5) + nodes.col(6) - nodes.col(0) - nodes.col(3) -
                             nodes.col(4) - nodes.col(7);
  const Eigen::Vector3d eta = nodes.col(2) + nodes.col(3) + nodes.col(6) + nodes.col(7) - nodes.col(0) - nodes.col(1) -
                              nodes.col(4) - nodes.col(5);
  const Eigen::Vector3d zeta = nodes.rightCols<4>().rowwise().sum() - nodes.leftCols<4>().rowwise().sum();
  double least = normalised_determinant(xi, eta, zeta);
  for (int a = 0; a < 8; ++a) {
    const auto edge = [&](int k) -> Eigen::Vector3d { return nodes.col(kNeighbours[a][k]) - nodes.col(a); };
    least = std::min(least, normalised_determinant(edge(0), edge(1), edge(2)));
  }
  return least;
}

namespace {

/// The smallest cosine between an edge of the deep face and its partner in the outer face. A column
/// that runs through the centre of a sphere comes out turned by half a circle, with good corners
/// everywhere: this tells.
double compute_edge_agreement(const Eigen::Matrix<double, 3, 8>& x) {
  double smallest = 1.0;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d deep = (x.col((k + 1) % 4) - x.col(k)).normalized();
    const Eigen::Vector3d outer = (x.col(4 + (k + 1) % 4) - x.col(4 + k)).normalized();
    smallest = std::min(smallest, deep.dot(outer));
  }
  return smallest;
}

/// Calls visit(level, i, j, quality, nodes) for every hexahedron; one turned over against its outer
/// face has the cosine that tells so for its quality.
template <typename Visit>
void visit_hexahedra(const LayeredGrid& grid, const Visit& visit) {
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
        visit(level, i, j, agreement > 0.0 ? compute_scaled_jacobian(x) : agreement, x);
      }
    }
  }
}

}  // namespace

WorstHexahedron find_worst_hexahedron(const LayeredGrid& grid) {
  WorstHexahedron worst;
  visit_hexahedra(grid, [&](int level, int, int, double quality, const Eigen::Matrix<double, 3, 8>& x) {
    if (quality < worst.scaled_jacobian) worst = {quality, level, x.rowwise().mean()};
  });
  return worst;
}

std::vector<Eigen::Vector3d> find_folded_places(const LayeredGrid& grid, double least) {
  std::vector<Eigen::Vector3d> places;
  visit_hexahedra(grid, [&](int, int i, int j, double quality, const Eigen::Matrix<double, 3, 8>&) {
    if (quality >= least) return;
    places.push_back(0.25 * (grid.nodes.col(grid.node(0, i, j)) + grid.nodes.col(grid.node(0, i + 1, j)) +
                             grid.nodes.col(grid.node(0, i + 1, j + 1)) + grid.nodes.col(grid.node(0, i, j + 1))));
  });
  return places;
}

}  // namespace lipofill::geometry
