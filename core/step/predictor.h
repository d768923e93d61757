#pragma once

#include <Eigen/Core>

#include "core/coupling/film_solve.h"
#include "core/mechanics/film_cells.h"
#include "core/mechanics/simulation_state.h"

namespace lipofill::step {

/// Shares of the velocities of the last four steps in that of the next, the latest first. With a
/// factor of earlier positions an iteration leaves a share rho of an error; in a mode that has
/// become twice as stiff rho = -1. The last velocity alone carries the error on, and where
/// rho < -1/3 it grows from step to step until only a new factor helps. These shares follow an
/// acceleration better than the last velocity does, cancel an error whose sign alternates, and let
/// none grow down to rho = -1, where the iteration itself no longer converges.
/// Checked by tests/unit/step/predictor_test.cc.
inline constexpr double kStartShares[4] = {0.625, 0.75, -0.125, -0.25};

/// Finds where the iteration of a step starts, by carrying the last steps on: x + dt v, p + dt
/// dp/dt, V + dt dV/dt. It decides how much is left to do, never the answer.
class Predictor {
 public:
  explicit Predictor(const mechanics::FilmCells& cells) : cells_(cells) {}

  /// Predicts positions to start a step of `dt` [s] from; after steps of other sizes, those that
  /// the last velocity leads to.
  static void predict_positions(const mechanics::SimulationState& from, double dt, Eigen::Matrix3Xd& positions);
  /// Predicts pressure and volume of every cell. After some steps of this size the films are
  /// carried on along a parabola, else along a line.
  void predict_films(const mechanics::SimulationState& from, double dt, coupling::FilmSolution& start);

 private:
  void predict_rate(const mechanics::SimulationState& from, double dt, Eigen::VectorXd mechanics::FilmState::*last,
                    Eigen::VectorXd mechanics::FilmState::*before);

  const mechanics::FilmCells& cells_;
  Eigen::VectorXd rate_;  ///< of every cell in the next step
  Eigen::VectorXd earlier_rate_;
};

}  // namespace lipofill::step
