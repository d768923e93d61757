#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <vector>

#include "core/film/film_grid.h"
#include "core/film/film_metric.h"

namespace lipofill::film {

/// Values of cells or edges, a vector or a part of one.
using Values = Eigen::Ref<const Eigen::VectorXd>;

/// Difference of a cell value across every open edge: (G p)_e = p_right - p_left.
/// Out-parameters of this folder are resized, which allocates nothing once they have their size.
void compute_edge_difference(const FilmGrid& grid, const Values& p, Eigen::VectorXd& difference);
Eigen::VectorXd compute_edge_difference(const FilmGrid& grid, const Values& p);

/// Net outflow of every cell, the paper's eq. 1: D = -G^T.
void compute_outflow(const FilmGrid& grid, const Values& flux, Eigen::VectorXd& outflow);
Eigen::VectorXd compute_outflow(const FilmGrid& grid, const Values& flux);

/// Coefficients of the quadratic form d^T w d of one quadrant in the differences across its xi-edge
/// and eta-edge; zero where the edge is sealed.
struct QuadrantForm {
  double w11 = 0.0;
  double w12 = 0.0;
  double w22 = 0.0;
};
using QuadrantForms = std::vector<std::array<QuadrantForm, 4>>;  ///< a cell

/// The forms of W(1), see apply_conductance: they change with the metric alone.
void compute_unit_forms(const FilmGrid& grid, const FilmMetric& metric, QuadrantForms& unit);

/// The forms of W(k) from those of W(1): w11 = k1 u11, w12 = sqrt(k1) sqrt(k2) u12, w22 = k2 u22.
/// @param root  sqrt(k), an edge; it is filled
void scale_forms(const FilmGrid& grid, const QuadrantForms& unit, const Eigen::VectorXd& k, Eigen::VectorXd& root,
                 QuadrantForms& forms);

/// Adds the flux W d of forms to `flux` (n_edges).
void add_flux_of_forms(const FilmGrid& grid, const QuadrantForms& forms, const Eigen::VectorXd& difference,
                       Eigen::Ref<Eigen::VectorXd> flux);
Eigen::VectorXd apply_forms(const FilmGrid& grid, const QuadrantForms& forms, const Eigen::VectorXd& difference);

/// Flux that differences across edges drive, W d, with the contravariant metric and a conductance
/// an edge:
///
///     d^T W d = sum over quadrants of 1/4 sqrt(g) [k1 g^11 d1^2 + 2 sqrt(k1 k2) g^12 d1 d2 + k2 g^22 d2^2]
///
/// If one of a quadrant's edges is sealed, its flux is zero, which leaves k2 / g_22 for the other.
/// W is symmetric and positive semi-definite on any chart. Flux is positive along increasing d; the
/// film's own is -W G p.
/// @param conductance  [m3/(Pa s)] (n_edges)
Eigen::VectorXd apply_conductance(const FilmGrid& grid, const FilmMetric& metric, const Eigen::VectorXd& conductance,
                                  const Eigen::VectorXd& difference);

/// The paper's J (eq. 3) with friction in it: J = G^T W G  [m3/(Pa s)]. Symmetric, positive semi-definite, constants of
/// each connected component in its null space, nine points a row. Second order on smooth charts,
/// orthogonal or not.
/// Checked by tests/unit/film/edge_operators_test.cc and
/// tests/verification/film/manufactured_*_test.cc.
class PressureOperator {
 public:
  explicit PressureOperator(const FilmGrid& grid);

  /// Both triangles, equal to the last bit, in a pattern that never changes.
  const Eigen::SparseMatrix<double>& assemble(const FilmGrid& grid, const FilmMetric& metric,
                                              const Eigen::VectorXd& conductance);
  /// factor (G^T W G + leaks). About 10 ns a cell; allocates nothing.
  /// @param leaks  conductance of every leaky wall of the grid, in the same unit as the forms
  const Eigen::SparseMatrix<double>& assemble(const QuadrantForms& forms, const Eigen::VectorXd& leaks, double factor);
  /// The matrix of the last assemble.
  const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }

 private:
  /// Places among the values to which the terms of a cell's quadrants are added. The term of a
  /// sealed side is zero and goes to the cell's own diagonal value.
  struct CellSlots {
    std::int32_t diagonal;
    std::int32_t neighbour_diagonal[4];     ///< Side is the index
    std::int32_t with_neighbour[4][2];      ///< (cell, neighbour) and (neighbour, cell)
    std::int32_t between_neighbours[4][2];  ///< a quadrant has the two neighbours that it touches
  };
  struct LeakSlots {
    std::int32_t left, right, left_right, right_left;
  };
  void build_pattern(const FilmGrid& grid);
  std::int32_t slot(int row, int column) const;
  CellSlots find_slots(const FilmGrid& grid, int cell) const;

  std::vector<CellSlots> cells_;
  std::vector<LeakSlots> leaks_;
  Eigen::SparseMatrix<double> matrix_;
};

/// Forms of the kinetic metric M(1) of edge velocities: U^T M(w) U = sum over quadrants of
/// 1/4 / sqrt(g) [w1 g_11 U1^2 + 2 sqrt(w1 w2) g_12 U1 U2 + w2 g_22 U2^2], which is the integral of
/// w |u|^2 over the film. U_e [m2/s] is the velocity normal to the edge times its length.
/// scale_forms gives those of M(w). Symmetric positive definite where the weights are positive.
void compute_unit_mass_forms(const FilmGrid& grid, const FilmMetric& metric, QuadrantForms& unit);

/// Velocity vectors at cell centres from edge velocities [m/s] (3, n_cells).
Eigen::Matrix3Xd compute_cell_velocity(const FilmGrid& grid, const FilmMetric& metric,
                                       const Eigen::VectorXd& edge_velocity);

}  // namespace lipofill::film
