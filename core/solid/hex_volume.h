#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/solid/hex_mesh.h"

namespace lipofill::solid {

/// Volume of the hexahedra of each material at the positions `x` (3, n_nodes), exact for trilinear
/// hexahedra [m3] (n_materials). Checked by tests/unit/solid/hex_volume_test.cc.
std::vector<double> compute_volumes(const HexMesh& mesh, const Eigen::Matrix3Xd& x, int n_materials);

}  // namespace lipofill::solid
