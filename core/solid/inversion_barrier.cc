#include "core/solid/inversion_barrier.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "core/solid/hex_shape.h"

namespace lipofill::solid {
namespace {

/// The corner's node, then the ends of its edges along xi, eta and zeta, ordered so that the edges' determinant is
/// positive.
constexpr int kCorners[8][4] = {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7},
                                {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}};

using Gradient = Eigen::Matrix<double, 9, 1>;
using Hessian = Eigen::Matrix<double, 9, 9>;

struct BarrierValue {
  double b, slope, curvature;
};

BarrierValue evaluate_log(double j) {
  const double d = j - 1.0;
  const double log_j = std::log(j);
  return {-d * d * log_j, -2.0 * d * log_j - d * d / j, -2.0 * log_j - 4.0 * d / j + d * d / (j * j)};
}

BarrierValue evaluate(double j) {
  if (j >= InversionBarrier::kLeastShare) return evaluate_log(j);
  const BarrierValue at = evaluate_log(InversionBarrier::kLeastShare);
  const double d = j - InversionBarrier::kLeastShare;
  return {at.b + at.slope * d + 0.5 * at.curvature * d * d, at.slope + at.curvature * d, at.curvature};
}

Eigen::Matrix3d gather_edges(const std::array<int, 8>& nodes, int corner, const Eigen::Matrix3Xd& x) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = x.col(nodes[kCorners[corner][k + 1]]) - x.col(nodes[kCorners[corner][0]]);
  return edges;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

/// d det[e]/de, edge by edge.
Gradient determinant_gradient(const Eigen::Matrix3d& e) {
  Gradient g;
  for (int k = 0; k < 3; ++k) g.segment<3>(3 * k) = e.col((k + 1) % 3).cross(e.col((k + 2) % 3));
  return g;
}

Hessian determinant_hessian(const Eigen::Matrix3d& e) {
  Hessian h = Hessian::Zero();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3;
    const int j = (k + 2) % 3;
    h.block<3, 3>(3 * i, 3 * j) = -cross_matrix(e.col(k));
    h.block<3, 3>(3 * j, 3 * i) = cross_matrix(e.col(k));
  }
  return h;
}

Hessian positive_part(const Hessian& h) {
  const Eigen::SelfAdjointEigenSolver<Hessian> eigen(h);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

InversionBarrier::InversionBarrier(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials) {
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    Element element;
    element.nodes = mesh.hexahedra[e];
    const HexNodes rest = mesh.gather(e, mesh.rest_positions);
    element.modulus =
        materials[mesh.material[e]].youngs_modulus * compute_jacobian(rest, LocalPoint::Zero()).determinant();
    for (int corner = 0; corner < 8; ++corner) {
      const double determinant = gather_edges(element.nodes, corner, mesh.rest_positions).determinant();
      element.inverse_rest[corner] = 1.0 / (kThreshold * determinant);
    }
    elements_.push_back(element);
  }
}

double InversionBarrier::add(const Eigen::Matrix3Xd& x, const SystemPattern& pattern, Eigen::VectorXd& values,
                             Eigen::VectorXd& force) const {
  double energy = 0.0;
  for (const Element& element : elements_) {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Matrix3d edges = gather_edges(element.nodes, corner, x);
      if (edges.determinant() * element.inverse_rest[corner] < 1.0) {
        energy += add_corner(element, corner, edges, pattern, values, force);
      }
    }
  }
  return energy;
}

double InversionBarrier::add_corner(const Element& element, int corner, const Eigen::Matrix3d& edges,
                                    const SystemPattern& pattern, Eigen::VectorXd& values,
                                    Eigen::VectorXd& force) const {
  const double scale = element.inverse_rest[corner];
  const BarrierValue barrier = evaluate(scale * edges.determinant());
  const Gradient g = scale * determinant_gradient(edges);
  const Gradient f = element.modulus * barrier.slope * g;
  const Hessian h = element.modulus * positive_part(barrier.curvature * g * g.transpose() +
                                                    barrier.slope * scale * determinant_hessian(edges));
  // From edges to nodes: e_k = x_k - x_0.
  Eigen::Matrix<double, 9, 12> to_edges;
  to_edges << -Eigen::Matrix3d::Identity().replicate<3, 1>(), Hessian::Identity();
  const Eigen::Matrix<double, 12, 1> nodal_force = to_edges.transpose() * f;
  const Eigen::Matrix<double, 12, 12> tangent = to_edges.transpose() * h * to_edges;
  int dofs[12];
  for (int k = 0; k < 12; ++k) {
    dofs[k] = pattern.dof_of_component()[3 * element.nodes[kCorners[corner][k / 3]] + k % 3];
  }
  for (int i = 0; i < 12; ++i) {
    if (dofs[i] < 0) continue;
    force[dofs[i]] += nodal_force[i];
    for (int j = 0; j < 12; ++j) {
      if (dofs[j] >= 0 && dofs[j] <= dofs[i]) values[pattern.find(dofs[i], dofs[j])] += tangent(i, j);
    }
  }
  return element.modulus * barrier.b;
}

}  // namespace lipofill::solid
