// Steps that grow by their error estimate.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

struct Outcome {
  double thickness = 0.0;  ///< at the probe when half the injection has spread [m]
  StepReport report;
};

Outcome run_to(double end, double max_step, double tolerance) {
  SimulationSpec spec = make_small_plan();
  spec.end = end;
  spec.settle_skin_speed = 0.0;
  spec.max_step = max_step;
  spec.error_tolerance = tolerance;
  const auto simulation = make_small_simulation(spec);
  while (simulation->phase() == Phase::kRunning) simulation->advance_step();
  EXPECT_EQ(simulation->phase(), Phase::kFinished) << simulation->reason();
  return {simulation->report().probe_thickness[0], simulation->report()};
}

TEST(AdaptiveStep, TakesFewerStepsForALooserTolerance) {
  const double end = 3.0;
  const Outcome fixed = run_to(end, 0.01, 0.1);
  const Outcome tight = run_to(end, 10.0, 2e-6);
  const Outcome loose = run_to(end, 10.0, 50e-6);
  EXPECT_EQ(fixed.report.rejected_steps, 0u);
  EXPECT_LT(loose.report.step, tight.report.step);
  EXPECT_LT(tight.report.step, fixed.report.step);
  EXPECT_LT(std::abs(tight.thickness - fixed.thickness), 20e-6);
  EXPECT_LT(std::abs(loose.thickness - fixed.thickness), 300e-6);
  EXPECT_LT(std::abs(tight.thickness - fixed.thickness), std::abs(loose.thickness - fixed.thickness));
}

TEST(AdaptiveStep, AcceptedLongStepsKeepTheirTolerance) {
  SimulationSpec spec = make_small_plan();
  spec.end = 20.0;
  spec.settle_skin_speed = 0.0;
  spec.max_step = 10.0;
  spec.error_tolerance = 5e-6;
  const auto simulation = make_small_simulation(spec);
  double longest = 0.0;
  while (simulation->phase() == Phase::kRunning) {
    simulation->advance_step();
    const StepReport& report = simulation->report();
    if (report.step_size > spec.step * 1.0000001) {
      EXPECT_LE(report.error_estimate, spec.error_tolerance);
    }
    longest = std::max(longest, report.step_size);
  }
  EXPECT_GT(longest, 10.0 * spec.step);
}

TEST(AdaptiveStep, SaysHowFarTheSkinHasStillToGo) {
  SimulationSpec spec = make_small_plan();
  spec.end = 60.0;
  spec.max_step = 2.0;
  spec.settle_skin_speed = 0.05e-3;
  const auto simulation = make_small_simulation(spec);
  while (simulation->phase() == Phase::kRunning) simulation->advance_step();
  ASSERT_EQ(simulation->phase(), Phase::kSettled) << simulation->reason();
  const double estimate = simulation->report().settling_error;
  SimulationSpec longer = spec;
  longer.settle_skin_speed = 1e-9;
  const auto rest = make_small_simulation(longer);
  while (rest->phase() == Phase::kRunning) rest->advance_step();
  const double left = std::abs(rest->report().skin_max_displacement - simulation->report().skin_max_displacement);
  EXPECT_GT(estimate, 0.0);
  EXPECT_LT(left, 5.0 * estimate + 1e-6);
}

}  // namespace
}  // namespace lipofill::simulation
