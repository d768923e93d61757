#include "core/solid/geometric_stiffness.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace lipofill::solid {
namespace {

using Gradients = Eigen::Matrix<double, 3, 8>;

/// dN_a/d(xi, eta, zeta) at the centre of a hexahedron, nodes ordered as in HexMesh.
Gradients centre_gradients() {
  Gradients g;
  g.row(0) << -1, 1, 1, -1, -1, 1, 1, -1;
  g.row(1) << -1, -1, 1, 1, -1, -1, 1, 1;
  g.row(2) << -1, -1, -1, -1, 1, 1, 1, 1;
  return 0.125 * g;
}

Eigen::Matrix3d positive_part(const Eigen::Matrix3d& stress) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(stress);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

GeometricStiffness::GeometricStiffness(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials,
                                       const SystemPattern& pattern) {
  const Gradients local = centre_gradients();
  const std::vector<int>& dofs = pattern.dof_of_component();
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    Element element;
    element.nodes = mesh.hexahedra[e];
    Eigen::Matrix<double, 3, 8> rest;
    for (int a = 0; a < 8; ++a) rest.col(a) = mesh.rest_positions.col(element.nodes[a]);
    const Eigen::Matrix3d jacobian = rest * local.transpose();
    element.gradient = jacobian.transpose().inverse() * local;
    element.volume = 8.0 * jacobian.determinant();
    const ElasticMaterial& material = materials[mesh.material[e]];
    const double nu = material.poisson_ratio;
    element.lambda = material.youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    element.mu = material.youngs_modulus / (2.0 * (1.0 + nu));
    int pair = 0;
    for (int a = 0; a < 8; ++a) {
      for (int b = 0; b <= a; ++b, ++pair) {
        for (int c = 0; c < 3; ++c) {
          const int i = dofs[3 * element.nodes[a] + c];
          const int j = dofs[3 * element.nodes[b] + c];
          element.targets[pair][c] = i < 0 || j < 0 ? -1 : pattern.find(i, j);
        }
      }
    }
    elements_.push_back(element);
  }
}

void GeometricStiffness::add(const Eigen::Matrix3Xd& x, Eigen::VectorXd& values) const {
  for (const Element& element : elements_) {
    Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
    for (int a = 0; a < 8; ++a) F += x.col(element.nodes[a]) * element.gradient.col(a).transpose();
    const Eigen::Matrix3d E = 0.5 * (F.transpose() * F - Eigen::Matrix3d::Identity());
    const Eigen::Matrix3d S = element.lambda * E.trace() * Eigen::Matrix3d::Identity() + 2.0 * element.mu * E;
    const Gradients weighted = element.volume * positive_part(S) * element.gradient;
    int pair = 0;
    for (int a = 0; a < 8; ++a) {
      for (int b = 0; b <= a; ++b, ++pair) {
        const double k = element.gradient.col(a).dot(weighted.col(b));
        for (const int target : element.targets[pair]) {
          if (target >= 0) values[target] += k;
        }
      }
    }
  }
}

}  // namespace lipofill::solid
