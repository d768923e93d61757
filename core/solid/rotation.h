#pragma once

#include <Eigen/Core>

namespace lipofill::solid {

/// The proper rotation R nearest to F, argmax tr(R^T F) over SO(3): the rotation of the polar
/// decomposition F = R U when det F > 0, and still a rotation, det R = +1, when F is singular or
/// turned inside out.
///
/// R's unit quaternion is the eigenvector of the largest eigenvalue of Horn's (1987) symmetric
/// 4 x 4 matrix. Depends on F alone, so a simulation restored from a snapshot takes the same path.
/// The identity for F with values that are not finite. Checked by
/// tests/unit/solid/rotation_test.cc.
Eigen::Matrix3d compute_nearest_rotation(const Eigen::Matrix3d& F);

}  // namespace lipofill::solid
