#include "core/solid/rotation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace lipofill::solid {

Eigen::Matrix3d compute_nearest_rotation(const Eigen::Matrix3d& F) {
  const double scale = F.cwiseAbs().maxCoeff();
  if (!F.allFinite() || scale == 0.0) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d A = F / scale;
  Eigen::Matrix4d N;                                           // order (w, x, y, z); only the lower triangle is read
  N << A.trace(), 0.0, 0.0, 0.0,                               //
      A(2, 1) - A(1, 2), 2.0 * A(0, 0) - A.trace(), 0.0, 0.0,  //
      A(0, 2) - A(2, 0), A(0, 1) + A(1, 0), 2.0 * A(1, 1) - A.trace(), 0.0,  //
      A(1, 0) - A(0, 1), A(0, 2) + A(2, 0), A(1, 2) + A(2, 1), 2.0 * A(2, 2) - A.trace();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(N);
  const Eigen::Vector4d q = eigen.eigenvectors().col(3);
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

}  // namespace lipofill::solid
