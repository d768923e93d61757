#pragma once

#include <array>
#include <vector>

#include "core/film/film_grid.h"

namespace lipofill::film {

/// The part of a cell that lies on one quadrilateral of another, finer grid of the chart.
struct CellPiece {
  int cell = 0;
  int quad_i = 0;  ///< of the finer grid
  int quad_j = 0;
  geometry::ChartBox box;
  /// The shares say what counts of the four points of the 2 x 2 Gauss rule on the box, s fastest: 1
  /// each where the piece lies inside the zone's outline, less where the outline cuts it
  /// (geometry::fit_gauss_shares).
  std::array<double, 4> share = {1.0, 1.0, 1.0, 1.0};
};

/// Cuts the slots of cells and of their fragments at the lines of a grid of n_xi x n_eta
/// quadrilaterals, cell by cell, every share 1.
std::vector<CellPiece> cut_cells(const FilmGrid& film, int n_xi, int n_eta);

}  // namespace lipofill::film
