#include "core/solid/hex_quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lipofill::solid {
namespace {

/// The neighbours of each corner, so ordered that a positively oriented element has a positive determinant.
constexpr int kNeighbours[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                   {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};

double normalised_determinant(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double product = a.squaredNorm() * b.squaredNorm() * c.squaredNorm();
  if (!(product > 0.0) || !std::isfinite(product)) return -1.0;
  return a.cross(b).dot(c) / std::sqrt(product);
}

}  // namespace

double compute_scaled_jacobian(const HexNodes& nodes) {
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

double compute_min_scaled_jacobian(const HexMesh& mesh, const Eigen::Matrix3Xd& x) {
  double least = 1.0;
  for (int e = 0; e < mesh.n_hexahedra(); ++e) least = std::min(least, compute_scaled_jacobian(mesh.gather(e, x)));
  return least;
}

}  // namespace lipofill::solid
