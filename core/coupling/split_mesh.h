#pragma once

#include <vector>

#include "core/geometry/layered_grid.h"
#include "core/solid/hex_mesh.h"

namespace lipofill::coupling {

/// The tissue's hexahedra with nodes doubled where a film may open.
struct SplitMesh {
  solid::HexMesh mesh;
  /// Node of the hexahedra outside (towards the skin) and inside of each place of each level; the
  /// same where the layers are bonded. (n_levels * nodes_per_level)
  std::vector<int> outer_node;
  std::vector<int> inner_node;
  /// Nodes that stand for bone under a film on the base: they belong to no hexahedron and must be
  /// fixed.
  std::vector<int> bone_nodes;
};

/// @param open  a list a level of nodes_per_level flags: the node is doubled there; empty where no
///              film lies at that
/// level.
///              At the deepest level the outer copy is free and the inner copy is bone.
/// Checked by tests/unit/coupling/gap_volume_test.cc.
SplitMesh split_mesh(const geometry::LayeredGrid& grid, const std::vector<std::vector<bool>>& open);

}  // namespace lipofill::coupling
