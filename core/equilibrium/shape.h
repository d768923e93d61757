#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/equilibrium/pools.h"

namespace lipofill::equilibrium {

/// The unknowns of an equilibrium. Its pressures are rows: a head of each pool, then a contact
/// pressure of each closed cell.
struct Shape {
  Eigen::VectorXd displacement;   ///< from rest, a value a degree of freedom [m]
  Eigen::VectorXd pressure;       ///< of each row [Pa]
  std::vector<int> closed;        ///< cells whose walls touch, ascending
  std::vector<char> is_at_limit;  ///< 1: the pool's pressure is the suction limit, its gap what it likes

  Eigen::Index n_rows() const { return pressure.size(); }

  /// All of them in one: the displacement, then the pressures.
  Eigen::VectorXd unknowns() const {
    Eigen::VectorXd all(displacement.size() + pressure.size());
    all << displacement, pressure;
    return all;
  }
  void move_by(const Eigen::VectorXd& unknowns) {
    displacement += unknowns.head(displacement.size());
    pressure += unknowns.tail(pressure.size());
  }

  /// The rest, with all pressures 0 and no cell closed.
  static Shape at_rest(int n_dofs, const Pools& pools) {
    return {Eigen::VectorXd::Zero(n_dofs),
            Eigen::VectorXd::Zero(pools.n()),
            {},
            std::vector<char>(static_cast<size_t>(pools.n()), 0)};
  }

  /// A cell's values by row: their sum over each pool, then those of the closed cells.
  Eigen::VectorXd reduce(const Pools& pools, const Eigen::VectorXd& of_cells) const {
    Eigen::VectorXd rows(n_rows());
    rows.head(pools.n()) = pools.sum(of_cells);
    for (size_t k = 0; k < closed.size(); ++k) rows[pools.n() + static_cast<Eigen::Index>(k)] = of_cells[closed[k]];
    return rows;
  }

  /// The transpose: values of rows, of each cell the sum of those it is in.
  Eigen::VectorXd spread(const Pools& pools, const Eigen::VectorXd& of_rows) const {
    Eigen::VectorXd cells(pools.n_cells());
    for (int cell = 0; cell < pools.n_cells(); ++cell) cells[cell] = of_rows[pools.of_cell[cell]];
    for (size_t k = 0; k < closed.size(); ++k) cells[closed[k]] += of_rows[pools.n() + static_cast<Eigen::Index>(k)];
    return cells;
  }
};

}  // namespace lipofill::equilibrium
