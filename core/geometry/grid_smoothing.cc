#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <vector>

#include "core/geometry/surface_chart.h"

namespace lipofill::geometry {
namespace {

/// A second difference: weights on a few grid points whose weighted sum is one term of the bending
/// energy.
struct BendingTerms {
  int n_xi;
  int n_eta;
  std::vector<Eigen::Triplet<double>> entries;

  int index(int i, int j) const { return j * (n_xi + 1) + i; }

  template <size_t N>
  void add(const std::array<int, N>& points, const std::array<double, N>& weights, double factor) {
    for (size_t a = 0; a < N; ++a) {
      for (size_t b = 0; b < N; ++b) {
        if (points[a] >= points[b]) entries.emplace_back(points[a], points[b], factor * weights[a] * weights[b]);
      }
    }
  }
};

Eigen::SparseMatrix<double> assemble_identity_plus_bending(int n_xi, int n_eta, const Eigen::Vector2d& spacing,
                                                           double length) {
  BendingTerms terms{n_xi, n_eta, {}};
  const double along_xi = std::pow(length / spacing.x(), 4);
  const double along_eta = std::pow(length / spacing.y(), 4);
  const double twist = 2.0 * std::sqrt(along_xi * along_eta);
  for (int j = 0; j <= n_eta; ++j) {
    for (int i = 0; i <= n_xi; ++i) {
      const int here = terms.index(i, j);
      terms.entries.emplace_back(here, here, 1.0);
      if (i > 0 && i < n_xi) terms.add<3>({here - 1, here, here + 1}, {1, -2, 1}, along_xi);
      const int up = n_xi + 1;
      if (j > 0 && j < n_eta) terms.add<3>({here - up, here, here + up}, {1, -2, 1}, along_eta);
      if (i < n_xi && j < n_eta) terms.add<4>({here, here + 1, here + up, here + up + 1}, {1, -1, -1, 1}, twist);
    }
  }
  const int n = (n_xi + 1) * (n_eta + 1);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(terms.entries.begin(), terms.entries.end());
  return matrix;
}

/// Derivative over the index k of n + 1 values spaced `stride` apart, from point `at`; second order
/// everywhere.
Eigen::Vector3d differentiate(const Eigen::Matrix3Xd& points, int at, int k, int n, int stride) {
  if (k == 0) return -1.5 * points.col(at) + 2.0 * points.col(at + stride) - 0.5 * points.col(at + 2 * stride);
  if (k == n) return 1.5 * points.col(at) - 2.0 * points.col(at - stride) + 0.5 * points.col(at - 2 * stride);
  return 0.5 * (points.col(at + stride) - points.col(at - stride));
}

}  // namespace

void smooth_over_grid(int n_xi, int n_eta, const Eigen::Vector2d& spacing, double length, Eigen::Matrix3Xd& values) {
  if (!(length > 0.0)) return;
  // I + energy is positive definite whatever the points, so the factorisation cannot fail.
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(
      assemble_identity_plus_bending(n_xi, n_eta, spacing, length));
  values = factor.solve(Eigen::MatrixX3d(values.transpose())).transpose().eval();
}

Eigen::Vector2d compute_mean_spacing(int n_xi, int n_eta, const Eigen::Matrix3Xd& points) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  const int up = n_xi + 1;
  for (int j = 0; j <= n_eta; ++j) {
    for (int i = 0; i <= n_xi; ++i) {
      const int here = j * up + i;
      if (i < n_xi) sum.x() += (points.col(here + 1) - points.col(here)).norm();
      if (j < n_eta) sum.y() += (points.col(here + up) - points.col(here)).norm();
    }
  }
  return {sum.x() / (static_cast<double>(n_xi) * (n_eta + 1)), sum.y() / (static_cast<double>(n_eta) * (n_xi + 1))};
}

Eigen::Matrix3Xd compute_grid_normals(int n_xi, int n_eta, const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd normals(3, points.cols());
  for (int j = 0; j <= n_eta; ++j) {
    for (int i = 0; i <= n_xi; ++i) {
      const int here = j * (n_xi + 1) + i;
      const Eigen::Vector3d along_xi = differentiate(points, here, i, n_xi, 1);
      const Eigen::Vector3d along_eta = differentiate(points, here, j, n_eta, n_xi + 1);
      normals.col(here) = along_xi.cross(along_eta).normalized();
    }
  }
  return normals;
}

}  // namespace lipofill::geometry
