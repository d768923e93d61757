#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/lanes.h"
#include "core/film/cell_pieces.h"
#include "core/film/film_grid.h"
#include "core/geometry/layered_grid.h"

namespace lipofill::coupling {

/// The two walls of a film: a node a place of the level, outside and inside (nodes_per_level each).
struct WallNodes {
  std::vector<int> outer;
  std::vector<int> inner;
};

/// The constant part of the gaps over a film's cells: the places of its pieces on the tissue's
/// quadrilaterals, and the places of their derivatives in the pattern. A piece is the part of a
/// quadrilateral that a cell covers; where an outline cuts it, its Gauss points have weights of
/// their own.
struct GapGeometry {
  /// kLanes pieces side by side; a lane that is left over has no cell.
  struct Batch {
    Lanes s[2], t[2];                        ///< Gauss points in the quadrilateral
    Lanes weight[4];                         ///< s fastest
    int outer[4][kLanes], inner[4][kLanes];  ///< nodes of the quadrilateral
    int wall_place[4][kLanes];               ///< each corner has its place in `wall_places`
    int cell[kLanes];                        ///< -1: none
  };
  /// A place of the walls under a cell, and where its six values of B are, -1: fixed.
  struct WallPlace {
    std::array<std::int32_t, 3> outer_slot, inner_slot;
  };
  /// A vertex of the film's grid: mean of four places of both walls.
  struct Vertex {
    std::array<int, 4> outer, inner;
    std::array<double, 4> weight;
  };

  int n_cells = 0;
  std::vector<Batch> batches;
  std::vector<WallPlace> wall_places;
  std::vector<Vertex> vertices;
  Eigen::SparseMatrix<double> pattern;  ///< holds zeros where B has entries (n_cells, n_dofs)
};

/// @param pieces  of the cells on the tissue's quadrilaterals, cell by cell
/// @param dof_of_component  degree of freedom of component c of node a at 3 a + c, -1 where fixed
GapGeometry make_gap_geometry(const geometry::LayeredGrid& tissue, const WallNodes& walls, const film::FilmGrid& film,
                              const std::vector<film::CellPiece>& pieces, const std::vector<int>& dof_of_component,
                              int n_dofs);

}  // namespace lipofill::coupling
