#pragma once

#include <Eigen/Core>

#include "core/geometry/hex_quality.h"
#include "core/solid/hex_mesh.h"

namespace lipofill::solid {

using geometry::compute_scaled_jacobian;

/// Least scaled Jacobian (geometry/hex_quality.h) of the mesh at the positions `x` (3, n_nodes); 1
/// for a mesh without hexahedra. About 35 nanoseconds an element. Checked by
/// tests/unit/solid/hex_quality_test.cc.
double compute_min_scaled_jacobian(const HexMesh& mesh, const Eigen::Matrix3Xd& x);

}  // namespace lipofill::solid
