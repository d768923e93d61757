#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "core/film/film_grid.h"
#include "core/geometry/layered_grid.h"

namespace lipofill::coupling {

/// The two walls of a film: a node a place of the level, outside and inside (nodes_per_level each).
struct WallNodes {
  std::vector<int> outer;
  std::vector<int> inner;
};

/// Gap volume over every film cell as a function of the node positions, and its exact derivative:
///
///     g_i(x) = int over cell i, 0 < s < 1 of  det(dX_s/dxi, dX_s/deta, X_out - X_in),   X_s = X_in + s (X_out - X_in)
///     B      = dg/dx       (the paper's A H; B^T p is the force of the film's pressure on the tissue)
///
/// Walls are bilinear on the tissue's quadrilaterals; cells may lie anywhere on them: each is cut along the
/// quadrilaterals' borders and integrated by 2 x 2 x 2 Gauss points a piece, which is exact. Checked by
/// tests/unit/coupling/gap_volume_test.cc (closed forms, finite differences, action equals reaction).
class GapVolume {
 public:
  /// @param dof_of_component  degree of freedom of component c of node a at 3 a + c, -1 where fixed
  GapVolume(const geometry::LayeredGrid& tissue, WallNodes walls, const film::FilmGrid& film,
            const std::vector<int>& dof_of_component, int n_dofs);

  /// Brings volume() and derivative() to the positions `x` (3, n_nodes) [m].
  void evaluate(const Eigen::Matrix3Xd& x);

  const Eigen::VectorXd& volume() const { return volume_; }                      ///< g [m3] (n_cells)
  const Eigen::SparseMatrix<double>& derivative() const { return derivative_; }  ///< B [m2] (n_cells, n_dofs)

  /// Positions of the film grid's vertices half-way between the walls [m] (3, n_vertices).
  Eigen::Matrix3Xd mid_surface(const Eigen::Matrix3Xd& x) const;

 private:
  /// A Gauss point of the chart: the quadrilateral it is in, shape functions there and their derivatives along the
  /// chart.
  struct Sample {
    std::array<int, 4> local;  ///< corners, as indices into the cell's places
    std::array<double, 4> n, n_xi, n_eta;
    double weight;
  };
  struct Cell {
    std::vector<int> places;  ///< places of the level that the cell's pieces touch
    std::vector<Sample> samples;
    std::vector<int> outer_slot, inner_slot;  ///< (3 a place) position in the values of B, -1: fixed
  };
  void add_samples(const geometry::LayeredGrid& tissue, const film::FilmGrid& film, int cell);
  void number_derivative(const std::vector<int>& dof_of_component, int n_dofs);
  double evaluate_cell(const Eigen::Matrix3Xd& x, const Cell& cell);

  WallNodes walls_;
  std::vector<Cell> cells_;
  struct VertexPlace {
    std::array<int, 4> places;
    std::array<double, 4> n;
  };
  std::vector<VertexPlace> vertices_;
  Eigen::VectorXd volume_;
  Eigen::SparseMatrix<double> derivative_;
  Eigen::Matrix3Xd outer_gradient_, inner_gradient_;  ///< of one cell, reused
};

/// Volume between two positions of a surface of nodes, positive where `current` lies outside of `rest` [m3].
double compute_swept_volume(const geometry::LayeredGrid& grid, const Eigen::Matrix3Xd& rest,
                            const Eigen::Matrix3Xd& current);

}  // namespace lipofill::coupling
