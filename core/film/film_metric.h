#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/film/film_grid.h"

namespace lipofill::film {

/// Covariant metric of the chart at a corner of a cell, in index coordinates (one cell is one
/// unit): g_ab = g_a . g_b with g_1, g_2 the sides of the cell that meet there;
/// sqrt_g = |g_1 x g_2| [m2].
struct QuadrantMetric {
  double g11 = 0.0;
  double g12 = 0.0;
  double g22 = 0.0;
  double sqrt_g = 0.0;
  double share = 1.0;  ///< of the quarter that lies inside the zone's outline
};

/// The film's mid-surface as it is now: the paper's distortion matrix, a quarter of a cell at a
/// time.
///
/// Quadrant q = s + 2 t of a cell is the quarter at corner (s, t); it touches the xi-edge on side s
/// and the eta-edge on side t. Every operator of the film is a sum over quadrants, which makes it
/// symmetric whatever the angle between xi and eta.
struct FilmMetric {
  std::vector<std::array<QuadrantMetric, 4>> quadrants;  ///< a cell
  /// [m2] (n_cells)  a = 1/4 sum of share sqrt_g, with the cell's fragments: exact on flat parallelograms and trapezia
  /// that no outline cuts, second order on others.
  Eigen::VectorXd area;
  Eigen::Matrix3Xd centre;    ///< [m]  (3, n_cells)
  Eigen::Matrix3Xd vertices;  ///< [m]  (3, n_vertices)
};

/// @param vertices  positions of all vertices of the grid, cells or not [m] (3, n_vertices)
/// Second order on smooth charts. Checked by tests/unit/film/edge_operators_test.cc.
FilmMetric compute_film_metric(const FilmGrid& grid, const Eigen::Matrix3Xd& vertices);

/// Brings the rest of a metric to its `vertices`. Allocates nothing once the metric has its size.
void update_film_metric(const FilmGrid& grid, FilmMetric& metric);

/// The edges a quadrant touches (-1: sealed).
struct QuadrantEdges {
  int xi = -1;
  int eta = -1;
};
inline QuadrantEdges quadrant_edges(const FilmGrid& grid, int cell, int quadrant) {
  return {grid.edge_of_side[cell][quadrant & 1], grid.edge_of_side[cell][2 + (quadrant >> 1)]};
}

}  // namespace lipofill::film
