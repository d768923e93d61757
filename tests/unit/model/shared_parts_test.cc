#include "core/model/shared_parts.h"

#include <gtest/gtest.h>

#include <thread>

#include "core/model/thicker_model.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using Pointer = std::unique_ptr<Simulation>;

Pointer create(const std::shared_ptr<const model::FaceModel>& model, const plan::SimulationSpec& spec) {
  auto simulation = Simulation::create(model, spec);
  EXPECT_TRUE(simulation.ok()) << simulation.status();
  return simulation.ok() ? *std::move(simulation) : nullptr;
}

std::string hash_after(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.advance_step();
  return simulation.state_hash();
}

void expect_sizes(const model::FaceModel& model, size_t tissues, size_t gaps, size_t analyses) {
  EXPECT_EQ(model.shared->tissues.size(), tissues);
  EXPECT_EQ(model.shared->gaps.size(), gaps);
  EXPECT_EQ(model.shared->analyses.size(), analyses);
}

TEST(SharedParts, AreOneForEqualZonesAndGoWithTheLastSimulation) {
  const auto model = make_small_model();
  const plan::SimulationSpec spec = make_small_plan();
  Pointer a = create(model, spec);
  plan::SimulationSpec other_injection = spec;
  other_injection.injections[0].volume *= 0.5;
  other_injection.fat_viscosity *= 2.0;
  Pointer b = create(model, other_injection);
  expect_sizes(*model, 1, 1, 1);
  a.reset();
  expect_sizes(*model, 1, 1, 1);
  b.reset();
  expect_sizes(*model, 0, 0, 0);
}

/// Models that differ in stiffness alone are copies of one, and share its parts.
TEST(SharedParts, AreOneForTissuesOfOtherStiffness) {
  const auto model = make_small_model();
  const plan::SimulationSpec spec = make_small_plan();
  model::FaceModelSpec stiffer_spec = make_small_model_spec();
  stiffer_spec.layers[0].material.youngs_modulus = 2.37e5;
  const auto built = model::build_face_model(stiffer_spec, nullptr);
  ASSERT_TRUE(built.ok()) << built.status();
  auto stiffer = std::make_shared<model::FaceModel>(*model);
  stiffer->layers[0].material.youngs_modulus = 2.37e5;
  stiffer->content_hash = (*built)->content_hash;
  const Pointer soft = create(model, spec);
  const Pointer stiff = create(stiffer, spec);
  expect_sizes(*model, 1, 1, 1);
  const std::string of_stiff = hash_after(*stiff, 12);
  EXPECT_EQ(of_stiff, hash_after(*create(*built, spec), 12));
  EXPECT_NE(of_stiff, hash_after(*soft, 12));
}

/// What thickness does not decide is shared with a thicker model; its steps are as if it were not.
TEST(SharedParts, AreOneForTissuesOfOtherThickness) {
  const auto model = make_small_model();
  const plan::SimulationSpec spec = make_small_plan();
  const Pointer nominal = create(model, spec);
  const auto thicker = model::make_thicker(*model, 0, 0.05);
  const Pointer sharing = create(thicker, spec);
  expect_sizes(*model, 2, 1, 1);
  EXPECT_EQ(thicker->shared, model->shared);
  auto apart = std::make_shared<model::FaceModel>(*thicker);
  apart->shared = model::make_shared_parts();
  const std::string of_thicker = hash_after(*sharing, 12);
  EXPECT_EQ(of_thicker, hash_after(*create(apart, spec), 12));
  EXPECT_NE(of_thicker, hash_after(*nominal, 12));
}

TEST(SharedParts, AreApartWhereThePlanMakesThemSo) {
  const auto model = make_small_model();
  const plan::SimulationSpec spec = make_small_plan();
  const Pointer a = create(model, spec);
  plan::SimulationSpec coarser = spec;
  coarser.films[0].n_xi = 3;
  const Pointer same_tissue = create(model, coarser);
  expect_sizes(*model, 1, 2, 2);
  plan::SimulationSpec narrower = spec;
  narrower.films[0].zones = {{"all", geometry::ChartBox{0.0, 2.0 / 3.0, 0.0, 1.0}}};
  const Pointer other_tissue = create(model, narrower);
  expect_sizes(*model, 2, 3, 3);
}

TEST(SharedParts, ChangeNoBit) {
  const plan::SimulationSpec spec = make_small_plan();
  const std::string alone = hash_after(*create(make_small_model(), spec), 12);
  const auto model = make_small_model();
  const Pointer first = create(model, spec);
  hash_after(*first, 3);
  std::vector<Pointer> sharing;
  for (int k = 0; k < 3; ++k) sharing.push_back(create(model, spec));
  std::vector<std::string> hashes(sharing.size());
  std::vector<std::thread> threads;
  for (size_t k = 0; k < sharing.size(); ++k) {
    threads.emplace_back([&, k] { hashes[k] = hash_after(*sharing[k], 12); });
  }
  for (std::thread& thread : threads) thread.join();
  expect_sizes(*model, 1, 1, 1);
  for (const std::string& hash : hashes) EXPECT_EQ(hash, alone);
  EXPECT_EQ(hash_after(*first, 9), alone);
}

}  // namespace
}  // namespace lipofill::simulation
