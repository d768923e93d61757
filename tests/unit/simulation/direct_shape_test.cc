// A plan whose goal is its settled shape: found in one step where nothing forbids it, and otherwise
// in steps, with the reason told.

#include <gmock/gmock.h>

#include <cmath>

#include "core/plan/step_rules.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

plan::SimulationSpec make_settled_plan() {
  plan::SimulationSpec spec = make_small_plan();
  spec.goal = plan::TimeGoal::kSettledShape;
  const plan::TimeFigures figures = plan::figures_of(spec.goal);
  spec.max_step = figures.max_step;
  spec.max_injection_step = figures.max_injection_step;
  spec.error_tolerance = figures.error_tolerance;
  spec.end = 600.0;
  return spec;
}

void run_to_its_end(Simulation& simulation) {
  while (simulation.phase() == Phase::kRunning) simulation.advance_step();
}

std::vector<float> skin_of(const Simulation& simulation) {
  for (const FrameField& field : simulation.frame({"skin"})) {
    if (field.name == "displacement") return field.values;
  }
  return {};
}

TEST(DirectShape, IsThereAfterOneStep) {
  const auto simulation = make_small_simulation(make_settled_plan());
  EXPECT_EQ(simulation->report().way, "directly") << "known before it runs";
  simulation->advance_step();
  EXPECT_EQ(simulation->phase(), Phase::kSettled) << simulation->reason();
  const StepReport& report = simulation->report();
  EXPECT_EQ(report.step, 1u);
  EXPECT_NEAR(report.time, 0.3, 1e-12) << "when all is injected";
  EXPECT_NEAR(report.injected, 0.3e-6, 1e-20);
  EXPECT_LT(report.film_volume_relative_error, 1e-12);
  EXPECT_LT(report.gap_volume_relative_error, 1e-12);
  EXPECT_NEAR(report.max_pressure, report.min_pressure, 1e-9 * report.max_pressure);
  EXPECT_EQ(report.skin_speed, 0.0);
  EXPECT_GT(report.elastic_energy, 0.0);
  EXPECT_GE(report.cost.factorisations, 1);
}

/// Against the same plan in steps until a thousandth of a millimetre is left to go.
TEST(DirectShape, IsTheOneThatStepsComeTo) {
  plan::SimulationSpec spec = make_settled_plan();
  spec.films[0].rest_thickness = geometry::ScalarField::constant(0.5e-3);
  const auto direct = make_small_simulation(spec);
  run_to_its_end(*direct);
  spec.goal = plan::TimeGoal::kTransient;
  spec.settle_skin_speed = 1e-12;
  spec.end = 1e6;
  const auto stepped = make_small_simulation(spec);
  while (stepped->phase() == Phase::kRunning &&
         (stepped->report().time < 1.0 || stepped->report().settling_error > 1e-6)) {
    stepped->advance_step();
  }
  EXPECT_EQ(stepped->report().way, "in steps: time.goal is TRANSIENT");
  const std::vector<float> a = skin_of(*direct);
  const std::vector<float> b = skin_of(*stepped);
  ASSERT_EQ(a.size(), b.size());
  for (size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 3e-3) << "millimetres";
  EXPECT_NEAR(direct->report().mean_pressure, stepped->report().mean_pressure, 1e-2 * stepped->report().mean_pressure);
}

TEST(DirectShape, WhatForbidsItIsToldAndStepsAreTaken) {
  plan::SimulationSpec spec = make_settled_plan();
  spec.fat_yield_stress = 2.0;
  const auto simulation = make_small_simulation(spec);
  EXPECT_THAT(simulation->report().way, StartsWith("in steps: fat.yield_stress_pa is 2 Pa"));
  simulation->advance_step();
  EXPECT_EQ(simulation->phase(), Phase::kRunning);
  EXPECT_LT(simulation->report().time, 0.3);
}

/// One ligament beside the needle, which breaks early, and one in a far corner.
plan::SimulationSpec make_plan_with_ligaments(double breaking_force_of_far, double rest_thickness) {
  plan::SimulationSpec spec = make_settled_plan();
  spec.films[0].rest_thickness = geometry::ScalarField::constant(rest_thickness);
  const auto at = [](double xi, double eta) { return std::vector<geometry::SkinPoint>{geometry::ChartPoint{xi, eta}}; };
  spec.ligaments = {{"near", "", "", at(0.55, 0.45), 200.0, 0.0, 0.02},
                    {"far", "", "", at(0.2, 0.8), 200.0, 0.0, breaking_force_of_far}};
  return spec;
}

/// Ligaments that may break: the way through the injection decides which, and from there the shape
/// is found directly; against the same plan in steps until a thousandth of a millimetre is left.
TEST(DirectShape, FinishesWhatIsInjectedInSteps) {
  plan::SimulationSpec spec = make_plan_with_ligaments(10.0, 0.5e-3);
  const auto finished = make_small_simulation(spec);
  EXPECT_THAT(finished->report().way, StartsWith("in steps until all is injected, then directly: ligaments[0]"));
  run_to_its_end(*finished);
  ASSERT_EQ(finished->phase(), Phase::kSettled) << finished->reason();
  EXPECT_EQ(finished->reason(), "the settled shape was found directly");
  EXPECT_EQ(finished->report().broken_ligament_points, 1);
  EXPECT_GT(finished->report().step, 3u);
  EXPECT_LT(finished->report().film_volume_relative_error, 1e-12);
  spec.goal = plan::TimeGoal::kTransient;
  spec.settle_skin_speed = 1e-12;
  spec.end = 1e6;
  const auto stepped = make_small_simulation(spec);
  while (stepped->phase() == Phase::kRunning &&
         (stepped->report().time < 1.0 || stepped->report().settling_error > 1e-6)) {
    stepped->advance_step();
  }
  EXPECT_EQ(stepped->report().broken_ligament_points, 1);
  const std::vector<float> a = skin_of(*finished), b = skin_of(*stepped);
  ASSERT_EQ(a.size(), b.size());
  for (size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 3e-3) << "millimetres";
}

/// Where the shape at rest would break another one, steps are taken on to see what becomes of it.
TEST(DirectShape, StepsOnWhereALigamentBreaksAfterTheInjection) {
  const auto make_plan = [](double breaking_force_of_far) {
    plan::SimulationSpec spec = make_plan_with_ligaments(breaking_force_of_far, 0.2e-3);
    // A wall that leaks: fat comes to the far side of it late.
    spec.films[0].walls = {{"septum", {geometry::ChartPoint{0.4, 0.0}, geometry::ChartPoint{0.4, 1.0}}, {}, 1e-10}};
    return spec;
  };
  const auto unbroken = make_small_simulation(make_plan(10.0));
  double while_injecting = 0.0;
  while (unbroken->phase() == Phase::kRunning) {
    unbroken->advance_step();
    if (unbroken->phase() == Phase::kRunning)
      while_injecting = std::max(while_injecting, unbroken->ligament_reports()[1].tension);
  }
  const double at_rest = unbroken->ligament_reports()[1].tension;
  ASSERT_GT(at_rest, 1.1 * while_injecting);
  const auto simulation = make_small_simulation(make_plan(0.5 * (while_injecting + at_rest)));
  run_to_its_end(*simulation);
  EXPECT_EQ(simulation->phase(), Phase::kSettled) << simulation->reason();
  EXPECT_EQ(simulation->report().way, "in steps: 'far' breaks after all is injected");
  EXPECT_EQ(simulation->report().broken_ligament_points, 2);
}

/// Tissue that fat enters above a pressure; a cell at the needle is its way in.
plan::SimulationSpec make_plan_with_entry(double entry_pressure) {
  plan::SimulationSpec spec = make_settled_plan();
  spec.films[0].rest_thickness = geometry::ScalarField::constant(0.2e-3);
  spec.films[0].connective_tissue = {2e5, entry_pressure};
  return spec;
}

/// The way through the injection decides which cells fat enters, and from there the shape is found
/// directly; against the same plan in steps until a thousandth of a millimetre is left.
TEST(DirectShape, FinishesWhereFatEntersNoMore) {
  plan::SimulationSpec spec = make_plan_with_entry(3e3);
  const auto finished = make_small_simulation(spec);
  EXPECT_THAT(
      finished->report().way,
      StartsWith("in steps until all is injected, then directly: films[0].connective_tissue.entry_pressure_pa"));
  run_to_its_end(*finished);
  ASSERT_EQ(finished->phase(), Phase::kSettled) << finished->reason();
  EXPECT_EQ(finished->reason(), "the settled shape was found directly") << finished->report().way;
  EXPECT_GT(finished->report().closed_cells, 3);
  EXPECT_LT(finished->report().closed_cells, 33);
  EXPECT_LT(finished->report().film_volume_relative_error, 1e-12);
  spec.goal = plan::TimeGoal::kTransient;
  spec.settle_skin_speed = 1e-12;
  spec.end = 1e6;
  const auto stepped = make_small_simulation(spec);
  while (stepped->phase() == Phase::kRunning &&
         (stepped->report().time < 1.0 || stepped->report().settling_error > 1e-6)) {
    stepped->advance_step();
  }
  EXPECT_EQ(stepped->report().closed_cells, finished->report().closed_cells);
  const std::vector<float> a = skin_of(*finished), b = skin_of(*stepped);
  ASSERT_EQ(a.size(), b.size());
  for (size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 3e-3) << "millimetres";
}

TEST(DirectShape, AFinishedShapeIsTheSameFromSnapshots) {
  const auto whole = make_small_simulation(make_plan_with_ligaments(10.0, 0.5e-3));
  const auto begun = make_small_simulation(make_plan_with_ligaments(10.0, 0.5e-3));
  for (int k = 0; k < 3; ++k) begun->advance_step();
  const auto restored = make_small_simulation(make_plan_with_ligaments(10.0, 0.5e-3));
  ASSERT_TRUE(restored->restore(begun->snapshot()).ok());
  run_to_its_end(*whole);
  run_to_its_end(*restored);
  EXPECT_EQ(restored->state_hash(), whole->state_hash());
  EXPECT_EQ(restored->report().way, whole->report().way);
}

TEST(DirectShape, TakingOutMoreThanThereIsNeedsSteps) {
  plan::SimulationSpec spec = make_settled_plan();
  spec.injections.push_back({"all", -1e-6, 1e-6, std::nullopt, std::nullopt});
  EXPECT_THAT(make_small_simulation(spec)->report().way, StartsWith("in steps: injections take "));
}

TEST(DirectShape, AnInjectionAddedBeforeItIsInIt) {
  plan::SimulationSpec spec = make_settled_plan();
  const auto added = make_small_simulation(spec);
  ASSERT_TRUE(added->inject({"all", 0.1e-6, 1e-6, std::nullopt, std::nullopt}).ok());
  run_to_its_end(*added);
  EXPECT_NEAR(added->report().injected, 0.4e-6, 1e-20);
  spec.injections.push_back({"all", 0.1e-6, 1e-6, std::nullopt, std::nullopt});
  const auto planned = make_small_simulation(spec);
  run_to_its_end(*planned);
  EXPECT_EQ(added->state_hash(), planned->state_hash());
}

/// Life goes on after it has settled: the next shape is again one step, and the shape of a plan
/// with all of it from the beginning but for the tolerance of forces; also from a snapshot.
TEST(DirectShape, AnInjectionAddedAfterwardsLeadsToTheNextShape) {
  const plan::InjectionSpec more{"all", 0.1e-6, 1e-6, std::nullopt, std::nullopt};
  plan::SimulationSpec spec = make_settled_plan();
  const auto added = make_small_simulation(spec);
  run_to_its_end(*added);
  const double settled_at = added->report().time;
  const std::string settled = added->snapshot();
  ASSERT_TRUE(added->inject(more).ok());
  EXPECT_EQ(added->phase(), Phase::kRunning);
  run_to_its_end(*added);
  EXPECT_EQ(added->phase(), Phase::kSettled);
  EXPECT_EQ(added->report().step, 2u);
  EXPECT_GT(added->report().time, settled_at);
  EXPECT_EQ(added->report().way, "directly");
  EXPECT_NEAR(added->report().injected, 0.4e-6, 1e-20);
  EXPECT_LT(added->report().film_volume_relative_error, 1e-12);

  const auto restored = make_small_simulation(spec);
  ASSERT_TRUE(restored->restore(settled).ok());
  ASSERT_TRUE(restored->inject(more).ok());
  run_to_its_end(*restored);
  EXPECT_EQ(restored->state_hash(), added->state_hash());

  spec.injections.push_back(more);
  const auto planned = make_small_simulation(spec);
  run_to_its_end(*planned);
  const std::vector<float> one = skin_of(*added), other = skin_of(*planned);
  ASSERT_EQ(one.size(), other.size());
  for (size_t k = 0; k < one.size(); ++k) EXPECT_NEAR(one[k], other[k], 1e-6) << "both are found from rest";
}

/// Taking out what was put in leads back.
TEST(DirectShape, WhatIsTakenOutAfterwardsLeadsBack) {
  const auto simulation = make_small_simulation(make_settled_plan());
  run_to_its_end(*simulation);
  const std::vector<float> before = skin_of(*simulation);
  for (const double volume : {0.1e-6, -0.1e-6}) {
    ASSERT_TRUE(simulation->inject({"all", volume, 1e-6, std::nullopt, std::nullopt}).ok());
    run_to_its_end(*simulation);
  }
  EXPECT_EQ(simulation->phase(), Phase::kSettled) << simulation->reason();
  const std::vector<float> after = skin_of(*simulation);
  for (size_t k = 0; k < before.size(); ++k) EXPECT_NEAR(before[k], after[k], 1e-6);
}

/// One that came to rest in steps goes on in steps.
TEST(DirectShape, ASteppedRunThatHasSettledGoesOnInSteps) {
  plan::SimulationSpec spec = make_settled_plan();
  spec.goal = plan::TimeGoal::kTransient;
  spec.settle_skin_speed = 0.5e-3;
  const auto simulation = make_small_simulation(spec);
  run_to_its_end(*simulation);
  ASSERT_EQ(simulation->phase(), Phase::kSettled) << simulation->reason();
  const uint64_t steps = simulation->report().step;
  ASSERT_TRUE(simulation->inject({"all", 0.1e-6, 1e-6, std::nullopt, std::nullopt}).ok());
  run_to_its_end(*simulation);
  EXPECT_EQ(simulation->phase(), Phase::kSettled) << simulation->reason();
  EXPECT_GT(simulation->report().step, steps + 5);
  EXPECT_NEAR(simulation->report().injected, 0.4e-6, 1e-18);
}

TEST(DirectShape, EqualPlansGiveEqualBytesAlsoFromSnapshots) {
  const auto first = make_small_simulation(make_settled_plan());
  const auto second = make_small_simulation(make_settled_plan());
  ASSERT_TRUE(second->restore(first->snapshot()).ok());
  run_to_its_end(*first);
  run_to_its_end(*second);
  EXPECT_EQ(first->state_hash(), second->state_hash());
  const auto third = make_small_simulation(make_settled_plan());
  ASSERT_TRUE(third->restore(first->snapshot()).ok());
  EXPECT_EQ(third->phase(), Phase::kSettled);
  EXPECT_EQ(third->state_hash(), first->state_hash());
  EXPECT_EQ(third->report().way, "directly");
  EXPECT_EQ(third->report().skin_max_displacement, first->report().skin_max_displacement);
}

/// A plan that was begun in steps goes on in them, and says so.
TEST(DirectShape, ASnapshotOfStepsGoesOnInThem) {
  plan::SimulationSpec spec = make_settled_plan();
  spec.goal = plan::TimeGoal::kTransient;
  const auto stepped = make_small_simulation(spec);
  for (int k = 0; k < 3; ++k) stepped->advance_step();
  const auto restored = make_small_simulation(make_settled_plan());
  ASSERT_TRUE(restored->restore(stepped->snapshot()).ok());
  EXPECT_EQ(restored->report().way, "in steps: it was begun in them");
  restored->advance_step();
  EXPECT_EQ(restored->report().step, 4u);
}

}  // namespace
}  // namespace lipofill::simulation
