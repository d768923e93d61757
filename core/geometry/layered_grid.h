#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace lipofill::geometry {

/// The structured grid of hexahedra under a charted region of skin, before any zone splits it.
///
/// Levels are surfaces of nodes: level 0 is the skin, the last level the deep face of the innermost
/// layer. Layer l has `elements_through[l]` hexahedra between its outer level `first_level(l)` and
/// its inner level `first_level(l + 1)`. Node (i, j) of a level sits at the chart point (i / n_xi,
/// j / n_eta); xi x eta points out of the face.
struct LayeredGrid {
  int n_xi = 0;
  int n_eta = 0;
  std::vector<int>
      elements_through;    ///< a number a layer, from the skin inwards; may be empty: then only level 0 exists
  Eigen::Matrix3Xd nodes;  ///< [m]  (3, n_levels * nodes_per_level)
  double min_scaled_jacobian = 1.0;  ///< worst over all hexahedra

  int n_layers() const { return static_cast<int>(elements_through.size()); }
  int nodes_per_level() const { return (n_xi + 1) * (n_eta + 1); }
  int n_levels() const { return first_level(n_layers()) + 1; }
  int first_level(int layer) const {
    int level = 0;
    for (int l = 0; l < layer; ++l) level += elements_through[l];
    return level;
  }
  int surface_index(int i, int j) const { return j * (n_xi + 1) + i; }
  int node(int level, int i, int j) const { return level * nodes_per_level() + surface_index(i, j); }
  int n_hexahedra() const { return (n_levels() - 1) * n_xi * n_eta; }
};

}  // namespace lipofill::geometry
