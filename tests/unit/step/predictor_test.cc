// Where a step starts, against what it promises: errors that a late factor leaves do not grow.

#include "core/step/predictor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lipofill::step {
namespace {

constexpr double kStep = 0.01;

/// One node that has stood still for long.
mechanics::SimulationState at_rest() {
  mechanics::SimulationState state;
  state.positions.setZero(3, 1);
  state.velocities.setZero(3, 1);
  for (Eigen::Matrix3Xd& earlier : state.earlier_velocities) earlier.setZero(3, 1);
  state.last_step = kStep;
  state.equal_steps = 100;
  return state;
}

void accept(const Eigen::Matrix3Xd& positions, double dt, mechanics::SimulationState& state) {
  for (int k = 2; k > 0; --k) state.earlier_velocities[k] = state.earlier_velocities[k - 1];
  state.earlier_velocities[0] = state.velocities;
  state.velocities = (positions - state.positions) / dt;
  state.positions = positions;
  state.equal_steps = dt == state.last_step ? state.equal_steps + 1 : 1;
  state.last_step = dt;
}

/// Largest error in steps 400 to 500, each of which leaves the share `rho` of the error it starts
/// with; 1 in the first.
double error_after_many_steps(double rho) {
  mechanics::SimulationState state = at_rest();
  accept(Eigen::Matrix3Xd::Ones(3, 1), kStep, state);
  double largest = 0.0;
  for (int step = 1; step < 500; ++step) {
    Eigen::Matrix3Xd start;
    Predictor::predict_positions(state, kStep, start);
    accept(rho * start, kStep, state);
    if (step >= 400) largest = std::max(largest, state.positions.cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST(StepStart, ErrorsDoNotGrowWhereTheIterationConverges) {
  for (double rho = -0.99; rho <= 0.9; rho += 0.03) EXPECT_LE(error_after_many_steps(rho), 0.5) << rho;
}

TEST(StepStart, TheLastVelocityAloneWouldLetThemGrow) {
  double last = 0.0, error = 1.0;
  for (int step = 0; step < 50; ++step) {
    const double next = -0.5 * (2.0 * error - last);
    last = error;
    error = next;
  }
  EXPECT_GT(std::abs(error), 1e5);
}

TEST(StepStart, SharesAddUpToOneAndCancelASignThatAlternates) {
  EXPECT_EQ(kStartShares[0] + kStartShares[1] + kStartShares[2] + kStartShares[3], 1.0);
  EXPECT_EQ(kStartShares[0] - kStartShares[1] + kStartShares[2] - kStartShares[3], 0.0);
}

/// Shares of velocities 1, 2, 3, 4 steps back: an acceleration is followed better than by the last
/// one, whose lag is 1.
TEST(StepStart, FollowsAnAccelerationBetterThanTheLastVelocity) {
  mechanics::SimulationState state = at_rest();
  for (int step = 1; step <= 10; ++step) accept(Eigen::Matrix3Xd::Constant(3, 1, step * step), kStep, state);
  Eigen::Matrix3Xd start;
  Predictor::predict_positions(state, kStep, start);
  const double last_velocity = 2.0 * 100.0 - 81.0;
  EXPECT_NEAR(121.0 - start(0, 0), 0.75 * (121.0 - last_velocity), 1e-9);
}

TEST(StepStart, AfterStepsOfOtherSizesTheLastVelocityLeads) {
  mechanics::SimulationState state = at_rest();
  for (int step = 1; step <= 10; ++step) accept(Eigen::Matrix3Xd::Constant(3, 1, step * step), kStep, state);
  Eigen::Matrix3Xd start;
  Predictor::predict_positions(state, 2.0 * kStep, start);
  EXPECT_NEAR(start(0, 0), 100.0 + 2.0 * 19.0, 1e-9);
  accept(Eigen::Matrix3Xd::Constant(3, 1, 140.0), 2.0 * kStep, state);
  for (int k = 1; k < 4; ++k) {
    Predictor::predict_positions(state, 2.0 * kStep, start);
    EXPECT_NEAR(start(0, 0), 140.0 + 40.0 * k, 1e-9);
    accept(start, 2.0 * kStep, state);
  }
}

}  // namespace
}  // namespace lipofill::step
