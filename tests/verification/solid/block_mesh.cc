#include "tests/verification/solid/block_mesh.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/solid/hex_shape.h"

namespace lipofill::solid::testing {

int BlockMesh::node_at(const Eigen::Vector3d& position) {
  std::array<long long, 3> key;
  for (int c = 0; c < 3; ++c) key[c] = std::llround(position[c] / merge_distance_);
  const auto [entry, is_new] = nodes_.try_emplace(key, static_cast<int>(positions_.size()));
  if (is_new) positions_.push_back(position);
  return entry->second;
}

void BlockMesh::add_block(const std::array<int, 3>& n, bool stacked,
                          const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& map) {
  const HexNodes corners = hex_corners();
  for (int e = 0; e < n[0] * n[1] * n[2]; ++e) {
    const Eigen::Vector3d cell(e % n[0], e / n[0] % n[1], e / (n[0] * n[1]));
    std::array<int, 8> hexahedron;
    for (int a = 0; a < 8; ++a) {
      const Eigen::Vector3d corner = cell + 0.5 * (corners.col(a) + Eigen::Vector3d::Ones());
      hexahedron[a] = node_at(map(corner.cwiseQuotient(Eigen::Vector3d(n[0], n[1], n[2]))));
    }
    mesh_.hexahedra.push_back(hexahedron);
    mesh_.material.push_back(0);
    mesh_.stacked.push_back(stacked);
  }
}

HexMesh BlockMesh::finish() const {
  HexMesh mesh = mesh_;
  mesh.rest_positions.resize(3, static_cast<Eigen::Index>(positions_.size()));
  for (size_t a = 0; a < positions_.size(); ++a) mesh.rest_positions.col(static_cast<Eigen::Index>(a)) = positions_[a];
  return mesh;
}

Eigen::Matrix3Xd compute_pressure_force(const HexMesh& mesh, const std::function<bool(int)>& is_loaded, bool deep_face,
                                        double pressure) {
  Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, mesh.n_nodes());
  const double side = deep_face ? -1.0 : 1.0;
  const double g = 1.0 / std::sqrt(3.0);
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    if (!is_loaded(e)) continue;
    const HexNodes nodes = mesh.gather(e, mesh.rest_positions);
    for (const LocalPoint& point :
         {LocalPoint(-g, -g, side), LocalPoint(g, -g, side), LocalPoint(g, g, side), LocalPoint(-g, g, side)}) {
      const Eigen::Matrix3d J = compute_jacobian(nodes, point);
      const Eigen::Vector3d traction = -side * pressure * J.col(0).cross(J.col(1));
      for (int a = 0; a < 8; ++a) force.col(mesh.hexahedra[e][a]) += compute_shape(point)[a] * traction;
    }
  }
  return force;
}

}  // namespace lipofill::solid::testing
