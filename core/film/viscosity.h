#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/film/edge_operators.h"
#include "core/film/film_grid.h"
#include "core/film/film_metric.h"
#include "core/film/rheology.h"

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
/// edge_operators.h. Sealed edges are free-slip side walls. First order in time, second in space on
/// smooth charts, orthogonal or not.
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
  /// A vertex whose four edges are open.
  struct InnerVertex {
    std::array<int, 4> cells;    ///< the index is (side of xi) + 2 (side of eta)
    int low, right, high, left;  ///< edges, in the sense of circulation
    double thickness_over_area;  ///< dt nu h/a_v of the step, h the mean of the cells around
  };
  void set_system(const FilmGrid& grid, const FilmMetric& metric, const Fat& fat, const Eigen::VectorXd& cell_thickness,
                  double dt);
  void set_diagonal(const FilmGrid& grid);
  void multiply(const FilmGrid& grid, const Eigen::VectorXd& u, Eigen::VectorXd& product);
  void solve(const FilmGrid& grid, const Eigen::VectorXd& right_side, Eigen::VectorXd& u);

  std::vector<InnerVertex> vertices_;
  QuadrantForms unit_mass_;
  QuadrantForms damped_mass_;
  QuadrantForms mass_;
  Eigen::VectorXd thickness_, damped_thickness_, root_;  ///< an edge
  Eigen::VectorXd over_area_;                            ///< dt nu h/a (n_cells)
  Eigen::VectorXd diagonal_;                             ///< near that of the system (n_edges)
  Eigen::VectorXd outflow_, momentum_, curl_;            ///< a product works in them
  Eigen::VectorXd right_side_, residual_, scaled_, direction_, product_;
};

}  // namespace lipofill::film
