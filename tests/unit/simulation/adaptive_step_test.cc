// Steps that grow by their error estimate.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/plan/step_rules.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

struct Outcome {
  double thickness = 0.0;  ///< the probe shows it when half the injection has spread [m]
  StepReport report;
};

Outcome run_to(double end, double max_step, double tolerance) {
  plan::SimulationSpec spec = make_small_plan();
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
  plan::SimulationSpec spec = make_small_plan();
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

/// Two injections with a pause before each, of lengths that no sum of equal steps meets.
plan::SimulationSpec make_plan_with_pauses() {
  plan::SimulationSpec spec = make_small_plan();
  spec.injections = {{"all", 0.1e-6, 0.3e-6, 0.1 + 1.0 / 7.0, std::nullopt},
                     {"all", 0.2e-6, 0.7e-6, 1.1, geometry::ChartPoint{0.55, 0.45}}};
  spec.settle_skin_speed = 0.0;
  spec.end = 5.0 / 3.0;
  return spec;
}

TEST(AdaptiveStep, EndsWhereInjectionsAndTheSimulationStartAndEnd) {
  plan::SimulationSpec spec = make_plan_with_pauses();
  spec.max_injection_step = 0.5;
  spec.max_step = 0.5;
  const double first = *spec.injections[0].start;
  const double first_end = first + 0.1e-6 / 0.3e-6;
  const double second_end = 1.1 + 0.2e-6 / 0.7e-6;
  const auto simulation = make_small_simulation(spec);
  std::vector<double> marks;
  double longest = 0.0, shortest = 1.0;
  for (double injected = 0.0; simulation->phase() == Phase::kRunning;) {
    simulation->advance_step();
    const StepReport& report = simulation->report();
    for (const double mark : {first, first_end, 1.1, second_end, spec.end}) {
      if (report.time == mark) marks.push_back(mark);
    }
    const bool injects = report.injected - injected > 1e-18;  // a round-off's worth may follow the end
    EXPECT_EQ(injects,
              (report.time > first && report.time <= first_end) || (report.time > 1.1 && report.time <= second_end))
        << report.time;
    injected = report.injected;
    longest = std::max(longest, report.step_size);
    shortest = std::min(shortest, report.step_size);
  }
  EXPECT_EQ(simulation->phase(), Phase::kFinished) << simulation->reason();
  EXPECT_EQ(marks, (std::vector<double>{first, first_end, 1.1, second_end, spec.end}));
  EXPECT_NEAR(simulation->report().injected, 0.3e-6, 1e-20);
  EXPECT_GT(longest, 5.0 * spec.step);
  EXPECT_GE(shortest, 0.5 * spec.step);
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-10);
}

TEST(AdaptiveStep, WhileInjectingKeepsItsTolerance) {
  plan::SimulationSpec fixed = make_plan_with_pauses();
  plan::SimulationSpec growing = fixed;
  growing.max_injection_step = 0.5;
  growing.error_tolerance = 20e-6;
  const auto a = make_small_simulation(fixed);
  const auto b = make_small_simulation(growing);
  while (a->phase() == Phase::kRunning) a->advance_step();
  while (b->phase() == Phase::kRunning) {
    b->advance_step();
    if (b->report().step_size > growing.step * 1.0000001) {
      EXPECT_LE(b->report().error_estimate, growing.error_tolerance);
    }
  }
  EXPECT_LT(b->report().step, a->report().step / 2);
  EXPECT_NEAR(b->report().probe_thickness[0], a->report().probe_thickness[0], 100e-6);
}

TEST(AdaptiveStep, ALiveInjectionStartsAndEndsWhereItShould) {
  plan::SimulationSpec spec = make_plan_with_pauses();
  spec.max_injection_step = 0.5;
  spec.max_step = 0.5;
  const auto simulation = make_small_simulation(spec);
  while (simulation->report().time < 0.5) simulation->advance_step();
  ASSERT_TRUE(simulation->inject({"all", 0.05e-6, 1e-6, 0.77, std::nullopt}).ok());
  const double end = 0.77 + 0.05e-6 / 1e-6;
  std::vector<double> injected_at_marks;
  while (simulation->phase() == Phase::kRunning && simulation->report().time < 1.1) {
    simulation->advance_step();
    const StepReport& report = simulation->report();
    if (report.time == 0.77 || report.time == end) injected_at_marks.push_back(report.injected);
  }
  ASSERT_EQ(injected_at_marks.size(), 2u);
  EXPECT_NEAR(injected_at_marks[1] - injected_at_marks[0], 0.05e-6, 1e-20);
}

TEST(SettledShape, IsThatOfShortStepsInAFewLongOnes) {
  plan::SimulationSpec spec = make_small_plan();
  spec.end = 600.0;
  spec.films[0].rest_thickness = geometry::ScalarField::constant(0.5e-3);
  spec.settle_skin_speed = 0.002e-3;
  spec.fat_yield_stress = 1e-6;  // of no consequence, but the shape is not found directly
  plan::SimulationSpec watched = spec;
  watched.max_step = 0.5;
  spec.goal = plan::TimeGoal::kSettledShape;
  const plan::TimeFigures figures = plan::figures_of(spec.goal);
  spec.max_step = figures.max_step;
  spec.max_injection_step = figures.max_injection_step;
  spec.error_tolerance = figures.error_tolerance;
  const auto a = make_small_simulation(watched);
  const auto b = make_small_simulation(spec);
  while (a->phase() == Phase::kRunning) a->advance_step();
  while (b->phase() == Phase::kRunning) b->advance_step();
  EXPECT_EQ(a->phase(), Phase::kSettled) << a->reason();
  EXPECT_EQ(b->phase(), Phase::kSettled) << b->reason();
  EXPECT_LT(b->report().step, a->report().step / 3);
  const double still_to_go = a->report().settling_error + b->report().settling_error;
  EXPECT_LT(still_to_go, 0.2e-3);
  EXPECT_NEAR(b->report().skin_max_displacement, a->report().skin_max_displacement, 10e-6 + still_to_go);
  EXPECT_NEAR(b->report().injected, 0.3e-6, 1e-20);
}

TEST(AdaptiveStep, SaysHowFarTheSkinHasStillToGo) {
  plan::SimulationSpec spec = make_small_plan();
  spec.end = 60.0;
  spec.max_step = 2.0;
  spec.settle_skin_speed = 0.05e-3;
  const auto simulation = make_small_simulation(spec);
  while (simulation->phase() == Phase::kRunning) simulation->advance_step();
  ASSERT_EQ(simulation->phase(), Phase::kSettled) << simulation->reason();
  const double estimate = simulation->report().settling_error;
  plan::SimulationSpec longer = spec;
  longer.settle_skin_speed = 1e-9;
  const auto rest = make_small_simulation(longer);
  while (rest->phase() == Phase::kRunning) rest->advance_step();
  const double left = std::abs(rest->report().skin_max_displacement - simulation->report().skin_max_displacement);
  EXPECT_GT(estimate, 0.0);
  EXPECT_LT(left, 5.0 * estimate + 1e-6);
}

}  // namespace
}  // namespace lipofill::simulation
