#include "core/solid/hex_volume.h"

#include "core/solid/hex_lanes.h"
#include "core/solid/neo_hookean_modes.h"

namespace lipofill::solid {

std::vector<double> compute_volumes(const HexMesh& mesh, const Eigen::Matrix3Xd& x, int n_materials) {
  std::vector<double> volumes(n_materials, 0.0);
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    const std::array<int, 8>& hexahedron = mesh.hexahedra[e];
    const Eigen::Vector3d origin = x.col(hexahedron[0]);
    Vector3<double> modes[8], slopes[8];
    for (int b = 0; b < 8; ++b) {
      const Eigen::Vector3d p = x.col(hexahedron[kCornerOfBinary[b]]) - origin;
      modes[b] = {p[0], p[1], p[2]};
    }
    transform_to_modes(modes);
    volumes[mesh.material[e]] += compute_volume(modes, slopes) / 64.0;
  }
  return volumes;
}

}  // namespace lipofill::solid
