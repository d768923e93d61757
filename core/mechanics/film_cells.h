#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mechanics/simulation_state.h"
#include "core/plan/film_layout.h"

namespace lipofill::mechanics {

/// Numbers the cells of all films, one film after the other, and says which of them lie on tissue.
struct FilmCells {
  std::vector<int> offset;       ///< first cell of each film among all, and one past the last
  std::vector<int> gap_of_film;  ///< index of each film in the gap system; -1: it has a wall of its own
  std::vector<int> on_tissue;    ///< cell of each row of the gap system, ascending

  int n() const { return offset.back(); }
  int n_of(size_t film) const { return offset[film + 1] - offset[film]; }
  bool is_on_tissue(size_t film) const { return gap_of_film[film] >= 0; }
  /// The film that a cell belongs to.
  int film_of(int cell) const;

  /// Values of the cells on tissue, in the order of the gap system's rows.
  void gather_tissue_part(const Eigen::VectorXd& all_cells, Eigen::VectorXd& part) const;
  /// One of the films' values, a cell each, for all films.
  void gather(const SimulationState& state, Eigen::VectorXd FilmState::*values, Eigen::VectorXd& all) const;
};

FilmCells number_cells(const std::vector<plan::FilmLayout>& films);

}  // namespace lipofill::mechanics
