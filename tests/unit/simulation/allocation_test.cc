// A step in its stride allocates nothing: counted at malloc, under which everything else lies.

#include <gtest/gtest.h>

#include "tests/unit/simulation/allocation_counter.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

constexpr int kWarmUpSteps = 12;
constexpr int kCountedSteps = 12;

long count_allocations_of_steps(const plan::SimulationSpec& spec, const model::FaceModelSpec& model_spec) {
  auto model = model::build_face_model(model_spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  if (!model.ok()) return -1;
  auto simulation = Simulation::create(*model, spec);
  EXPECT_TRUE(simulation.ok()) << simulation.status();
  if (!simulation.ok()) return -1;
  for (int k = 0; k < kWarmUpSteps; ++k) (*simulation)->advance_step();
  const long counted = lipofill::testing::count_allocations_of([&] {
    for (int k = 0; k < kCountedSteps; ++k) (*simulation)->advance_step();
  });
  EXPECT_EQ((*simulation)->phase(), Phase::kRunning) << (*simulation)->reason();
  return counted;
}

TEST(Allocation, AStepOfFewCellsHasNone) {
  EXPECT_EQ(count_allocations_of_steps(make_small_plan(), make_small_model_spec()), 0);
}

TEST(Allocation, AStepOfManyCellsHasNone) {
  // Pressures by conjugate gradients.
  model::FaceModelSpec model = make_small_model_spec();
  model.n_xi = model.n_eta = 24;
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].n_xi = spec.films[0].n_eta = 12;
  EXPECT_EQ(count_allocations_of_steps(spec, model), 0);
}

TEST(Allocation, AStepOfFatWithInertiaOrYieldStressHasNone) {
  plan::SimulationSpec spec = make_small_plan();
  spec.fat_viscosity = 0.05;
  EXPECT_EQ(count_allocations_of_steps(spec, make_small_model_spec()), 0);
  spec.fat_viscosity = 10.0;
  spec.fat_yield_stress = 20.0;
  EXPECT_EQ(count_allocations_of_steps(spec, make_small_model_spec()), 0);
}

}  // namespace
}  // namespace lipofill::simulation
