// What is said of a run that ended before its skin was at rest.

#include <gmock/gmock.h>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> remarks_at_the_end(const plan::SimulationSpec& spec) {
  const auto simulation = make_small_simulation(spec);
  while (simulation->phase() == Phase::kRunning) simulation->advance_step();
  EXPECT_EQ(simulation->phase(), Phase::kFinished) << simulation->reason();
  return simulation->remarks();
}

/// A bump of fat that starts to spread in steps too short for the tissue to be at its full speed.
plan::SimulationSpec make_start() {
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].rest_thickness = geometry::ScalarField::constant(1e-3);
  spec.films[0].initial_thickness = geometry::ScalarField{3, 3, {1e-3, 1e-3, 1e-3, 1e-3, 3e-3, 1e-3, 1e-3, 1e-3, 1e-3}};
  spec.injections.clear();
  spec.step = 1e-5;
  spec.end = 3e-5;
  return spec;
}

TEST(ResultRemarks, AnEndThatCameTooEarlySaysHowFarTheSkinHasToGo) {
  plan::SimulationSpec spec = make_small_plan();
  spec.end = 0.6;
  EXPECT_THAT(remarks_at_the_end(spec), Contains(AllOf(HasSubstr("still to go at the end"), HasSubstr("raise end_s"))));
}

TEST(ResultRemarks, SkinWhoseSpeedRisesAgainIsSaidNotToComeToRest) {
  plan::SimulationSpec spec = make_start();
  EXPECT_THAT(remarks_at_the_end(spec),
              Contains(AllOf(HasSubstr("does not come to rest"), HasSubstr("time.goal SETTLED_SHAPE"))));
  spec.settle_skin_speed = 0.0;  // nobody asked for rest
  EXPECT_THAT(remarks_at_the_end(spec), Not(Contains(HasSubstr("come to rest"))));
}

}  // namespace
}  // namespace lipofill::simulation
