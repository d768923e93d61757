#include "core/solid/hex_quality.h"

#include <algorithm>

namespace lipofill::solid {

double compute_min_scaled_jacobian(const HexMesh& mesh, const Eigen::Matrix3Xd& x) {
  double least = 1.0;
  for (int e = 0; e < mesh.n_hexahedra(); ++e) least = std::min(least, compute_scaled_jacobian(mesh.gather(e, x)));
  return least;
}

}  // namespace lipofill::solid
