#include "core/coupling/split_mesh.h"

#include <array>

namespace lipofill::coupling {
namespace {

void number_nodes(const geometry::LayeredGrid& grid, const std::vector<std::vector<bool>>& open, SplitMesh& split) {
  const int n_places = grid.n_levels() * grid.nodes_per_level();
  split.outer_node.resize(n_places);
  split.inner_node.resize(n_places);
  std::vector<int> place_of_node;
  const auto add_node = [&](int place) {
    place_of_node.push_back(place);
    return static_cast<int>(place_of_node.size()) - 1;
  };
  for (int level = 0; level < grid.n_levels(); ++level) {
    for (int s = 0; s < grid.nodes_per_level(); ++s) {
      const int place = level * grid.nodes_per_level() + s;
      split.outer_node[place] = split.inner_node[place] = add_node(place);
      if (open[level].empty() || !open[level][s]) continue;
      split.inner_node[place] = add_node(place);
      if (level == grid.n_levels() - 1) split.bone_nodes.push_back(split.inner_node[place]);
    }
  }
  split.mesh.rest_positions.resize(3, place_of_node.size());
  for (size_t n = 0; n < place_of_node.size(); ++n) {
    split.mesh.rest_positions.col(n) = grid.nodes.col(place_of_node[n]);
  }
}

/// Hexahedra between `level` and `level + 1`: their skin side takes the inner nodes of the level
/// above them, and so on.
void add_hexahedra(const geometry::LayeredGrid& grid, int level, int material, bool stacked, SplitMesh& split) {
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) {
      const std::array<int, 4> corners = {grid.surface_index(i, j), grid.surface_index(i + 1, j),
                                          grid.surface_index(i + 1, j + 1), grid.surface_index(i, j + 1)};
      std::array<int, 8> hexahedron;
      for (int c = 0; c < 4; ++c) {
        hexahedron[c] = split.outer_node[(level + 1) * grid.nodes_per_level() + corners[c]];
        hexahedron[c + 4] = split.inner_node[level * grid.nodes_per_level() + corners[c]];
      }
      split.mesh.hexahedra.push_back(hexahedron);
      split.mesh.material.push_back(material);
      split.mesh.stacked.push_back(stacked);
    }
  }
}

}  // namespace

SplitMesh split_mesh(const geometry::LayeredGrid& grid, const std::vector<std::vector<bool>>& open) {
  SplitMesh split;
  number_nodes(grid, open, split);
  for (int layer = 0; layer < grid.n_layers(); ++layer) {
    for (int level = grid.first_level(layer); level < grid.first_level(layer + 1); ++level) {
      add_hexahedra(grid, level, layer, grid.elements_through[layer] > 1, split);
    }
  }
  return split;
}

}  // namespace lipofill::coupling
