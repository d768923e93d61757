#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <map>

#include "core/solid/hex_mesh.h"

namespace lipofill::solid::testing {

/// Builds a mesh of mapped blocks, joined where their nodes coincide.
class BlockMesh {
 public:
  /// `merge_distance`: nodes nearer than that are one.
  explicit BlockMesh(double merge_distance) : merge_distance_(merge_distance) {}

  /// n[0] x n[1] x n[2] hexahedra, `map` from the unit cube.
  void add_block(const std::array<int, 3>& n, bool stacked,
                 const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& map);

  HexMesh finish() const;

 private:
  int node_at(const Eigen::Vector3d& position);

  double merge_distance_;
  std::map<std::array<long long, 3>, int> nodes_;
  std::vector<Eigen::Vector3d> positions_;
  HexMesh mesh_;
};

/// Consistent nodal forces of a uniform pressure on the given face of the given hexahedra: the face
/// towards the skin (nodes 4-7) or the deep face (nodes 0-3), pushing inwards through it. (3,
/// n_nodes) [N]
Eigen::Matrix3Xd compute_pressure_force(const HexMesh& mesh, const std::function<bool(int)>& is_loaded, bool deep_face,
                                        double pressure);

}  // namespace lipofill::solid::testing
