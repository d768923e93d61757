#pragma once

#include <Eigen/Core>

#include "core/solid/hex_mesh.h"
#include "core/solid/hex_shape.h"

namespace lipofill::solid {

/// Scaled Jacobian of a hexahedron: the least, over its corners and its centre, of the determinant of the three
/// normalised edge (at the centre: principal axis) vectors. 1 for a cuboid, not positive when the element is folded, -1
/// when an edge has no length or a position is not finite. As Verdict defines it (Stimpson et al. 2007). Checked by
/// tests/unit/solid/hex_quality_test.cc.
double compute_scaled_jacobian(const HexNodes& nodes);

/// Least scaled Jacobian of the mesh at the positions `x` (3, n_nodes); 1 for a mesh without hexahedra. About 0.1
/// microseconds an element.
double compute_min_scaled_jacobian(const HexMesh& mesh, const Eigen::Matrix3Xd& x);

}  // namespace lipofill::solid
