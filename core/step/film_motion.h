#pragma once

#include <Eigen/Core>

#include "core/film/advection.h"
#include "core/film/film_metric.h"
#include "core/film/viscosity.h"
#include "core/mechanics/simulation_state.h"

namespace lipofill::step {

/// Moves the fat of one film by viscosity and advection alone: the velocity that the pressure then
/// corrects.
/// Checked by tests/unit/film/motion_test.cc and tests/verification/film/.
class FilmMotion {
 public:
  explicit FilmMotion(const film::FilmGrid& grid) : grid_(grid), viscosity_(grid), advection_(grid) {}

  /// @param velocity  out: U after `dt` [s] [m2/s] (n_edges)
  void advance(const film::FilmMetric& metric, const film::Fat& fat, const mechanics::FilmState& film, double dt,
               Eigen::VectorXd& velocity);

 private:
  const film::FilmGrid& grid_;
  film::ImplicitViscosity viscosity_;
  film::Advection advection_;
  Eigen::VectorXd thickness_, edge_thickness_, viscous_;
};

}  // namespace lipofill::step
