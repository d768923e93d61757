#include "core/solid/inversion_barrier.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lipofill::solid {
namespace {

/// The corner's node, then the ends of its edges along xi, eta and zeta, ordered so that the edges'
/// determinant is positive.
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

Eigen::Matrix3d gather_edges(const HexNodes& nodes, int corner) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = nodes.col(kCorners[corner][k + 1]) - nodes.col(kCorners[corner][0]);
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

double InversionBarrier::find_largest_corner(const HexNodes& nodes) {
  double largest = 0.0;
  for (int corner = 0; corner < 8; ++corner) largest = std::max(largest, gather_edges(nodes, corner).determinant());
  return largest;
}

template <typename Visit>
void InversionBarrier::for_each_squeezed_corner(int hexahedron, double youngs_modulus, const Eigen::Matrix4Xd& x,
                                                Visit visit) const {
  const HexNodes rest = mesh_->gather(hexahedron, mesh_->rest_positions);
  HexNodes now;
  for (int a = 0; a < 8; ++a) now.col(a) = x.col(mesh_->hexahedra[hexahedron][a]).head<3>();
  for (int index = 0; index < 8; ++index) {
    const Eigen::Matrix3d edges = gather_edges(now, index);
    const double inverse_rest = 1.0 / (kThreshold * gather_edges(rest, index).determinant());
    if (!(edges.determinant() * inverse_rest < 1.0)) continue;
    const double modulus = youngs_modulus * compute_jacobian(rest, LocalPoint::Zero()).determinant();
    visit(Corner{index, edges, inverse_rest, modulus});
  }
}

double InversionBarrier::add_force(int hexahedron, double youngs_modulus, const Eigen::Matrix4Xd& x,
                                   Eigen::Matrix4Xd& force) const {
  double energy = 0.0;
  for_each_squeezed_corner(hexahedron, youngs_modulus, x, [&](const Corner& corner) {
    const double scale = corner.inverse_rest;
    const BarrierValue barrier = evaluate(scale * corner.edges.determinant());
    const Gradient f = corner.modulus * barrier.slope * scale * determinant_gradient(corner.edges);
    const auto node = [&](int k) {
      return force.col(mesh_->hexahedra[hexahedron][kCorners[corner.index][k]]).head<3>();
    };
    for (int k = 0; k < 3; ++k) {
      node(k + 1) += f.segment<3>(3 * k);
      node(0) -= f.segment<3>(3 * k);
    }
    energy += corner.modulus * barrier.b;
  });
  return energy;
}

void InversionBarrier::add_tangent(int hexahedron, double youngs_modulus, const Eigen::Matrix4Xd& x,
                                   const SystemPattern& pattern, TangentValues& values) const {
  // The map from edges to nodes: e_k = x_k - x_0.
  Eigen::Matrix<double, 9, 12> to_edges;
  to_edges << -Eigen::Matrix3d::Identity().replicate<3, 1>(), Hessian::Identity();
  for_each_squeezed_corner(hexahedron, youngs_modulus, x, [&](const Corner& corner) {
    const double scale = corner.inverse_rest;
    const BarrierValue barrier = evaluate(scale * corner.edges.determinant());
    const Gradient g = scale * determinant_gradient(corner.edges);
    const Hessian h = corner.modulus * positive_part(barrier.curvature * g * g.transpose() +
                                                     barrier.slope * scale * determinant_hessian(corner.edges));
    const Eigen::Matrix<double, 12, 12> tangent = to_edges.transpose() * h * to_edges;
    int dofs[12];
    for (int k = 0; k < 12; ++k) {
      dofs[k] = pattern.dof_of_component()[3 * mesh_->hexahedra[hexahedron][kCorners[corner.index][k / 3]] + k % 3];
    }
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j < 12; ++j) {
        const bool is_lower = dofs[j] >= 0 && dofs[j] <= dofs[i];
        if (is_lower) values.add_geometric(pattern.find(dofs[i], dofs[j]), tangent(i, j));
      }
    }
  });
}

}  // namespace lipofill::solid
