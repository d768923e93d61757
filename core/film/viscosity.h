#pragma once

#include <Eigen/Core>

#include "core/film/edge_operators.h"
#include "core/film/film_grid.h"
#include "core/film/film_metric.h"
#include "core/film/rheology.h"
#include "core/film/viscous_system.h"

namespace lipofill::film {

/// Implicit viscosity of the film: in-plane diffusion and friction on both walls,
///
///     h (u' - u)/dt = nu [grad(h div u') - curl(h curl u')] - h (12 nu/h^2) u'
///
/// as the symmetric positive definite system on edge velocities U [m2/s]
///
///     [M(h (1 + 12 nu dt/h^2)) + dt nu (D^T (h/a) D + M(1) K^T (h/a_v) K M(1))] U' = M(h) U
///
/// with D the net outflow of cells, K the circulation around vertices and M the kinetic metric of
/// edge_operators.h: the matrix is a ViscousSystem. Sealed edges are free-slip side walls. First
/// order in time, second in space on smooth charts, orthogonal or not.
///
/// Solved by conjugate gradients, preconditioned by the diagonal, from what friction alone would
/// leave, to 1e-13 in the norm of the inverse diagonal. With friction that is a few iterations;
/// each is linear in the cells. After the first call nothing is allocated. Checked by
/// tests/unit/film/motion_test.cc and tests/verification/film/manufactured_viscosity_test.cc.
class ImplicitViscosity {
 public:
  explicit ImplicitViscosity(const FilmGrid& grid);

  /// @param cell_thickness  h [m] (n_cells)
  /// @param edge_thickness  h [m] (n_edges); a dry edge ends with no velocity
  /// @param next            U', not `velocity` itself
  /// Unconditionally stable.
  void advance(const FilmGrid& grid, const FilmMetric& metric, const Fat& fat, const Eigen::VectorXd& cell_thickness,
               const Eigen::VectorXd& edge_thickness, const Eigen::VectorXd& velocity, double dt,
               Eigen::VectorXd& next);
  Eigen::VectorXd advance(const FilmGrid& grid, const FilmMetric& metric, const Fat& fat,
                          const Eigen::VectorXd& cell_thickness, const Eigen::VectorXd& edge_thickness,
                          const Eigen::VectorXd& velocity, double dt);

 private:
  void solve(const FilmGrid& grid, Eigen::VectorXd& u);

  ViscousSystem system_;
  QuadrantForms mass_;                                   ///< M(h)
  Eigen::VectorXd thickness_, damped_thickness_, root_;  ///< an edge
  Eigen::VectorXd right_side_, residual_, scaled_, direction_, product_;
};

}  // namespace lipofill::film
