#include "core/solid/enhanced_strain.h"

namespace lipofill::solid {

StrainOperator compute_covariant_strain_operator(const HexNodes& nodes, const LocalPoint& point) {
  const Eigen::Matrix<double, 8, 3> dN = compute_shape_derivatives(point);
  const Eigen::Matrix3d J = nodes * dN;
  StrainOperator B;
  for (int row = 0; row < 6; ++row) {
    const auto [i, j] = kVoigt[row];
    for (int a = 0; a < 8; ++a) {
      const Eigen::Vector3d shear = J.col(i) * dN(a, j) + J.col(j) * dN(a, i);
      B.block<1, 3>(row, 3 * a) = (row < 3 ? 0.5 : 1.0) * shear.transpose();
    }
  }
  return B;
}

Eigen::Matrix<double, 6, 6> compute_strain_transform(const Eigen::Matrix3d& jacobian) {
  const Eigen::Matrix3d A = jacobian.inverse();  // A(i, k) = dxi_i/dX_k
  Eigen::Matrix<double, 6, 6> T;
  for (int row = 0; row < 6; ++row) {
    const auto [k, l] = kVoigt[row];
    for (int column = 0; column < 6; ++column) {
      const auto [i, j] = kVoigt[column];
      T(row, column) = (row < 3 ? 0.5 : 1.0) * (A(i, k) * A(j, l) + A(j, k) * A(i, l));
    }
  }
  return T;
}

}  // namespace lipofill::solid
