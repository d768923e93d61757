#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/film/film_grid.h"
#include "core/film/film_metric.h"

namespace lipofill::film {

/// Semi-Lagrangian advection of the film's velocity along the curved mid-surface, u'(x) = u(foot of
/// the path that ends at x).
///
/// Paths are traced in the chart by the midpoint rule and stop at walls. The velocity is carried as
/// a vector of space and made tangential where it arrives, which is parallel transport to second
/// order. Unconditionally stable; a step is of second order in space and time, the whole of first
/// order in time; a step of no length changes nothing. After the first call nothing is allocated.
/// Checked by tests/unit/film/motion_test.cc and
/// tests/verification/film/manufactured_advection_test.cc.
class Advection {
 public:
  explicit Advection(const FilmGrid& grid);

  /// @param velocity  U, normal velocity times edge length [m2/s] (n_edges)
  /// @param next      U', not `velocity` itself
  void advance(const FilmMetric& metric, const Eigen::VectorXd& velocity, double dt, Eigen::VectorXd& next);

 private:
  const FilmGrid* grid_;
  std::vector<double> flux_xi_;   ///< crosses lines of constant xi, (n_xi + 1, n_eta); 0 on sealed edges
  std::vector<double> flux_eta_;  ///< crosses lines of constant eta, (n_xi, n_eta + 1)
};

Eigen::VectorXd advect_velocity(const FilmGrid& grid, const FilmMetric& metric, const Eigen::VectorXd& velocity,
                                double dt);

}  // namespace lipofill::film
