#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "core/film/film_grid.h"
#include "core/film/film_metric.h"

namespace lipofill::film {

/// Difference of a cell value across every open edge: (G p)_e = p_right - p_left.
Eigen::VectorXd compute_edge_difference(const FilmGrid& grid, const Eigen::VectorXd& p);

/// Net outflow of every cell, the paper's eq. 1: D = -G^T.
Eigen::VectorXd compute_outflow(const FilmGrid& grid, const Eigen::VectorXd& flux);

/// Coefficients of the quadratic form d^T w d of one quadrant in the differences across its xi-edge and eta-edge; zero
/// where the edge is sealed.
struct QuadrantForm {
  double w11 = 0.0;
  double w12 = 0.0;
  double w22 = 0.0;
};
using QuadrantForms = std::vector<std::array<QuadrantForm, 4>>;  ///< a cell

/// The forms whose sum is W(conductance), see apply_conductance.
QuadrantForms compute_conductance_forms(const FilmGrid& grid, const FilmMetric& metric,
                                        const Eigen::VectorXd& conductance);

/// Flux W d of forms  (n_edges).
Eigen::VectorXd apply_forms(const FilmGrid& grid, const QuadrantForms& forms, const Eigen::VectorXd& difference);

/// Flux that differences across edges drive, W d, with the contravariant metric and a conductance an edge:
///
///     d^T W d = sum over quadrants of 1/4 sqrt(g) [k1 g^11 d1^2 + 2 sqrt(k1 k2) g^12 d1 d2 + k2 g^22 d2^2]
///
/// Where one of a quadrant's edges is sealed its flux is zero, which leaves k2 / g_22 for the other. W is symmetric and
/// positive semi-definite on any chart. Flux is positive along increasing d; the film's own is -W G p.
/// @param conductance  [m3/(Pa s)] (n_edges)
Eigen::VectorXd apply_conductance(const FilmGrid& grid, const FilmMetric& metric, const Eigen::VectorXd& conductance,
                                  const Eigen::VectorXd& difference);

/// The paper's J (eq. 3) with friction in it: J = G^T W G  [m3/(Pa s)]. Symmetric, positive semi-definite, constants of
/// each connected component in its null space, nine points a row. Second order on smooth charts, orthogonal or not.
/// Checked by tests/unit/film/edge_operators_test.cc and tests/verification/film/manufactured_*_test.cc.
class PressureOperator {
 public:
  explicit PressureOperator(const FilmGrid& grid);

  /// Both triangles, in a pattern that never changes.
  const Eigen::SparseMatrix<double>& assemble(const FilmGrid& grid, const FilmMetric& metric,
                                              const Eigen::VectorXd& conductance);
  /// @param leaks  conductance of every leaky wall of the grid, in the same unit as the forms
  const Eigen::SparseMatrix<double>& assemble(const FilmGrid& grid, const QuadrantForms& forms,
                                              const Eigen::VectorXd& leaks);

 private:
  Eigen::SparseMatrix<double> matrix_;
};

/// Kinetic metric of edge velocities: U^T M U = sum over quadrants of 1/4 / sqrt(g) [w1 g_11 U1^2 + 2 sqrt(w1 w2) g_12
/// U1 U2 + w2 g_22 U2^2], which is the integral of w |u|^2 over the film. U_e [m2/s] is the velocity normal to the edge
/// times its length. Symmetric positive definite where the weights are positive.
Eigen::SparseMatrix<double> assemble_velocity_mass(const FilmGrid& grid, const FilmMetric& metric,
                                                   const Eigen::VectorXd& weight);

/// Velocity vectors at cell centres from edge velocities [m/s] (3, n_cells).
Eigen::Matrix3Xd compute_cell_velocity(const FilmGrid& grid, const FilmMetric& metric,
                                       const Eigen::VectorXd& edge_velocity);

}  // namespace lipofill::film
