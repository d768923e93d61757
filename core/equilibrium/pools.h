#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "core/mechanics/film_cells.h"
#include "core/plan/film_layout.h"

namespace lipofill::equilibrium {

/// The pools of all films on tissue: cells that open edges and leaky walls connect, so that fat at
/// rest holds one head in them. Cells are numbered as rows of the gap system. A zone in two pieces
/// is two pools, and a cell that fat has yet to enter is one of its own. Checked by
/// tests/unit/equilibrium/pools_test.cc.
struct Pools {
  std::vector<int> of_cell;        ///< pool of each cell on tissue
  std::vector<std::string> names;  ///< of each pool: its zones, joined by " + "

  int n() const { return static_cast<int>(names.size()); }
  int n_cells() const { return static_cast<int>(of_cell.size()); }

  /// The sum of a cell's values over each pool (n).
  Eigen::VectorXd sum(const Eigen::VectorXd& of_cells) const;
};

/// Pools in the order of their first cells.
/// @param entered  a film: 1 where fat has entered the cell, else 0 (n_cells), no values where all cells are open;
///                 no film: all are
Pools find_pools(const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
                 const std::vector<Eigen::VectorXd>& entered = {});

}  // namespace lipofill::equilibrium
