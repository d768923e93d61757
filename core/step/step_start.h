#pragma once

#include <Eigen/Core>

#include "core/mechanics/simulation_state.h"

namespace lipofill::step {

/// Where the iteration of a step starts: the last steps carried on. It decides how much is left to do, never the
/// answer.

/// Shares of the velocities of the last four steps in that of the next, the latest first. With a factor of earlier
/// positions an iteration leaves a share rho of an error; in a mode that has become twice as stiff rho = -1. The last
/// velocity alone carries the error on, and where rho < -1/3 it grows from step to step until only a new factor helps.
/// These shares follow an acceleration better than the last velocity does, cancel an error whose sign alternates, and
/// let none grow down to rho = -1, where the iteration itself no longer converges.
/// Checked by tests/unit/step/step_start_test.cc.
inline constexpr double kStartShares[4] = {0.625, 0.75, -0.125, -0.25};

/// Positions to start a step of `dt` [s] from; after steps of other sizes, those that the last velocity leads to.
void predict_positions(const mechanics::SimulationState& from, double dt, Eigen::Matrix3Xd& positions);

}  // namespace lipofill::step
