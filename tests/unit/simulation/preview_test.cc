// The settled shape as a coarse model foresees it.

#include "core/simulation/preview.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

/// A square of 24 x 24 with a zone in its middle that comes to rest in some seconds.
model::FaceModelSpec make_model_spec() {
  model::FaceModelSpec spec = make_small_model_spec();
  spec.n_xi = spec.n_eta = 24;
  return spec;
}

plan::SimulationSpec make_plan() {
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].n_xi = spec.films[0].n_eta = 12;
  spec.films[0].zones = {{"all", geometry::ChartBox{0.16, 0.84, 0.16, 0.84}}};
  spec.films[0].rest_thickness = geometry::ScalarField::constant(0.3e-3);
  spec.settle_skin_speed = 0.01e-3;
  spec.max_step = 0.5;
  spec.end = 120.0;
  return spec;
}

std::unique_ptr<Simulation> make_full(const plan::SimulationSpec& spec) {
  const auto model = model::build_face_model(make_model_spec(), nullptr);
  auto made = Simulation::create(*model, spec);
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

std::unique_ptr<Preview> run_preview(const Simulation& full) {
  auto made = Preview::create(full.shared_model(), full.spec());
  EXPECT_TRUE(made.ok()) << made.status();
  while ((*made)->phase() == Phase::kRunning) (*made)->advance_step();
  return *std::move(made);
}

double largest_length(const std::vector<float>& vectors) {
  double largest = 0.0;
  for (size_t k = 0; k + 2 < vectors.size(); k += 3) {
    largest = std::max<double>(largest, std::hypot(vectors[k], vectors[k + 1], vectors[k + 2]));
  }
  return largest;
}

TEST(Preview, ForeseesTheSettledShapeInAFractionOfTheSteps) {
  // The preview is at rest; the simulation of the plan is to be as well.
  plan::SimulationSpec plan = make_plan();
  plan.settle_skin_speed = 1e-7;
  plan.end = 2000.0;
  const auto full = make_full(plan);
  const auto preview = run_preview(*full);
  ASSERT_EQ(preview->phase(), Phase::kSettled) << preview->reason();
  while (full->phase() == Phase::kRunning) full->advance_step();
  ASSERT_EQ(full->phase(), Phase::kSettled) << full->reason();
  EXPECT_EQ(preview->n_hexahedra(), full->n_hexahedra() / 4);
  EXPECT_LT(preview->n_film_cells(), full->n_film_cells() / 3);
  EXPECT_LT(preview->report().step, full->report().step / 3);
  EXPECT_NEAR(preview->report().injected, full->report().injected, 1e-18);
  const double lift = full->report().skin_max_displacement;
  EXPECT_NEAR(preview->report().skin_max_displacement, lift, 0.2 * lift);
  const PreviewDifference difference = compare_preview(preview->frame(), preview->report(), *full);
  EXPECT_GT(difference.max, 0.0);
  EXPECT_LT(difference.max, 0.25 * lift);
  EXPECT_LT(difference.rms, 0.5 * difference.max);
  EXPECT_NEAR(difference.volume, 0.0, 0.05 * full->report().skin_volume_change);
}

TEST(Preview, IsShownOnTheMeshesOfTheFullModel) {
  const auto full = make_full(make_plan());
  const auto preview = run_preview(*full);
  const std::vector<FrameField> shown = preview->frame();
  const std::vector<FrameField> expected = full->frame({"skin"});
  ASSERT_EQ(shown.size(), expected.size());
  for (size_t k = 0; k < shown.size(); ++k) {
    EXPECT_EQ(shown[k].name, expected[k].name);
    EXPECT_EQ(shown[k].unit, expected[k].unit);
    EXPECT_EQ(shown[k].values.size(), expected[k].values.size());
  }
  EXPECT_NEAR(largest_length(shown[0].values), 1e3 * preview->report().skin_max_displacement, 1e-5)
      << "every second node of the full skin is one of the coarse skin";
}

TEST(Preview, ComparesWithItselfAsEqual) {
  const auto full = make_full(make_plan());
  for (int k = 0; k < 5; ++k) full->advance_step();
  const PreviewDifference none = compare_preview(full->frame({}), full->report(), *full);
  EXPECT_EQ(none.max, 0.0);
  EXPECT_EQ(none.rms, 0.0);
  EXPECT_EQ(none.volume, 0.0);
  std::vector<FrameField> lifted = full->frame({"skin"});
  for (size_t k = 2; k < lifted[0].values.size(); k += 3) lifted[0].values[k] += 2.0f;
  const PreviewDifference two = compare_preview(lifted, full->report(), *full);
  EXPECT_NEAR(two.max, 2e-3, 1e-9);
  EXPECT_NEAR(two.rms, 2e-3, 1e-9);
}

TEST(Preview, LeavesNoTraceInTheFullRun) {
  const auto alone = make_full(make_plan());
  const auto beside = make_full(make_plan());
  auto preview = Preview::create(beside->shared_model(), beside->spec());
  ASSERT_TRUE(preview.ok()) << preview.status();
  for (int k = 0; k < 30; ++k) {
    alone->advance_step();
    (*preview)->advance_step();
    beside->advance_step();
  }
  EXPECT_EQ(alone->state_hash(), beside->state_hash());
}

TEST(Preview, GivesTheSameBytesEveryTime) {
  const auto full = make_full(make_plan());
  const auto a = run_preview(*full);
  const auto b = run_preview(*full);
  EXPECT_EQ(a->frame()[0].values, b->frame()[0].values);
}

TEST(Preview, SeesInjectionsThatWereAddedToThePlan) {
  const auto full = make_full(make_plan());
  ASSERT_TRUE(full->inject({"all", 0.1e-6, 1e-6, std::nullopt, std::nullopt}).ok());
  const auto preview = run_preview(*full);
  EXPECT_NEAR(preview->report().injected, 0.4e-6, 1e-18);
}

TEST(Preview, SaysWhatACoarseGridCannotHold) {
  plan::SimulationSpec spec = make_plan();
  // Between the centres of the coarse film's cells.
  spec.films[0].zones = {{"all", geometry::ChartBox{0.26, 0.32, 0.16, 0.84}}};
  spec.injections = {{"all", 0.05e-6, 1e-6, std::nullopt, std::nullopt}};
  spec.probes.clear();
  const auto full = make_full(spec);
  const auto preview = Preview::create(full->shared_model(), full->spec());
  ASSERT_FALSE(preview.ok());
  EXPECT_THAT(std::string(preview.status().message()), testing::HasSubstr("make the zone at least two cells wide"));
}

TEST(Preview, GivesUpAfterABoundedNumberOfSteps) {
  plan::SimulationSpec spec = make_plan();
  spec.settle_skin_speed = 0.0;  // never
  spec.end = 1e6;
  const auto full = make_full(spec);
  const auto preview = run_preview(*full);
  EXPECT_EQ(preview->phase(), Phase::kFailed);
  EXPECT_EQ(preview->report().step, Preview::kMostSteps);
  EXPECT_THAT(preview->reason(), testing::HasSubstr("500 steps"));
}

}  // namespace
}  // namespace lipofill::simulation
