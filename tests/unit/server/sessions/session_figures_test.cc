#include "server/sessions/session_figures.h"

#include <gtest/gtest.h>

#include "tests/unit/server/sessions/session_fixture.h"

namespace lipofill::server {
namespace {

TEST(SessionFigures, FollowTheSimulationWhenTheyAreMeasured) {
  const auto simulation = make_simulation(1.0);
  SessionFigures figures(*simulation, SimulationState::kPaused, std::nullopt);
  EXPECT_EQ(figures.copy().n_film_cells, simulation->n_film_cells());
  EXPECT_EQ(figures.state(), SimulationState::kPaused);
  simulation->advance_step();
  EXPECT_EQ(figures.copy().report.step, 0u);
  figures.measure(*simulation, 0.25);
  const SessionView view = figures.copy();
  EXPECT_EQ(view.report.step, 1u);
  EXPECT_EQ(view.wall_s, 0.25);
  ASSERT_EQ(view.zones.size(), 1u);
  EXPECT_EQ(view.zones[0].name, "all");
}

TEST(SessionFigures, SumTheCostOfStepsAndTakeTheMedianOfTheirTimes) {
  const auto simulation = make_simulation(1.0);
  SessionFigures figures(*simulation, SimulationState::kReady, std::nullopt);
  EXPECT_EQ(figures.step_ms_median(), 0.0);
  mechanics::StepCost cost;
  cost.film_iterations = 3;
  for (const double ms : {8.0, 1.0, 2.0}) figures.count_step(cost, ms);
  EXPECT_EQ(figures.step_ms_median(), 2.0);
  figures.measure(*simulation, 0.0);
  EXPECT_EQ(figures.copy().cost.film_iterations, 9u);
}

TEST(SessionFigures, StateAndReasonChangeWithoutTheRest) {
  const auto simulation = make_simulation(1.0);
  SessionFigures figures(*simulation, SimulationState::kReady, PreviewView());
  figures.set_state(SimulationState::kRunning, "");
  figures.set_reason("no checkpoint: the disk is full");
  EXPECT_EQ(figures.state(), SimulationState::kRunning);
  EXPECT_EQ(figures.latest().reason, "no checkpoint: the disk is full");
  EXPECT_TRUE(figures.copy().preview.has_value());
  SessionView last;
  last.state = SimulationState::kSettled;
  last.state_hash = "ab";
  figures.show(last);
  EXPECT_EQ(figures.copy().state_hash, "ab");
  EXPECT_EQ(figures.copy().n_film_cells, 0);
}

}  // namespace
}  // namespace lipofill::server
