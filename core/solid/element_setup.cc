// The constant numbers of batches, from an element's stiffness and rest shape.

#include <Eigen/LU>

#include "core/solid/element_batch.h"

namespace lipofill::solid {
namespace {

using ModalMatrix = Eigen::Matrix<double, 18, 18>;

/// h_k(b), row a node in the order of HexMesh, column a mode.
Eigen::Matrix<double, 8, 8> hadamard_basis() {
  Eigen::Matrix<double, 8, 8> h;
  for (int b = 0; b < 8; ++b) {
    for (int k = 0; k < 8; ++k) {
      double product = 1.0;
      for (int bit = 1; bit < 8; bit *= 2) {
        if (k & bit) product *= (b & bit) ? 1.0 : -1.0;
      }
      h(kCornerOfBinary[b], k) = product;
    }
  }
  return h;
}

constexpr int kHourglass[4] = {3, 5, 6, 7};

/// K_q = P^T K P with d = P q: d_b = sum_j h_j(b) G J e_j + 1/8 sum_k h_k(b) q_k, G the symmetric
/// gradient.
ModalMatrix compute_modal_stiffness(const Eigen::Matrix3d& jacobian, const HexStiffness& K) {
  static const Eigen::Matrix<double, 8, 8> h = hadamard_basis();
  Eigen::Matrix<double, 24, 18> P;
  for (int a = 0; a < 8; ++a) {
    const Eigen::Vector3d along = h(a, 1) * jacobian.col(0) + h(a, 2) * jacobian.col(1) + h(a, 4) * jacobian.col(2);
    auto rows = P.middleRows<3>(3 * a);
    rows.setZero();
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      rows(i, i) = along[i];
      rows(i, 3 + i) = 0.5 * along[j];
      rows(j, 3 + i) = 0.5 * along[i];
    }
    for (int k = 0; k < 4; ++k) rows.middleCols<3>(6 + 3 * k).diagonal().setConstant(0.125 * h(a, kHourglass[k]));
  }
  const ModalMatrix modal = P.transpose() * (K * P);
  return 0.5 * (modal + modal.transpose());
}

}  // namespace

void ElementBatch::set_lane(int lane, const std::array<int, 8>& hexahedron, const HexNodes& positions,
                            const HexStiffness& K) {
  const Eigen::Matrix3d jacobian = compute_jacobian(positions, LocalPoint::Zero());
  const Eigen::Matrix3d inverse = jacobian.inverse();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inverse_jacobian[i][j][lane] = 0.125 * inverse(i, j);
  }
  const Eigen::Matrix<double, 3, 8> modes = (positions.colwise() - positions.col(0)) * hadamard_basis();
  for (int k = 0; k < 4; ++k) {
    for (int c = 0; c < 3; ++c) rest_hourglass[k][c][lane] = modes(c, kHourglass[k]);
  }
  const ModalMatrix modal = compute_modal_stiffness(jacobian, K);
  Lanes* to = modal_stiffness;
  for (int row = 0; row < 6; ++row) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) (*to++)[lane] = modal(3 * row + i, 3 * row + j);
    }
    for (int column = 0; column < row; ++column) {
      for (int k = 0; k < 9; ++k) (*to++)[lane] = modal(3 * row + k / 3, 3 * column + k % 3);
    }
  }
  for (int b = 0; b < 8; ++b) nodes[b][lane] = hexahedron[kCornerOfBinary[b]];
}

void StiffnessBatch::set_lane(int lane, const HexStiffness& K) {
  Lanes* to = numbers;
  for (int a = 0; a < 8; ++a) {
    const int row = 3 * kCornerOfBinary[a];
    for (int b = 0; b < a; ++b) {
      for (int k = 0; k < 9; ++k) (*to++)[lane] = K(row + k / 3, 3 * kCornerOfBinary[b] + k % 3);
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) (*to++)[lane] = K(row + i, row + j);
    }
  }
}

}  // namespace lipofill::solid
