// The settled shape of a plan with volumes that change: the one that the plan itself comes to with
// those volumes, by either way; what is refused, and what it leaves.

#include "core/simulation/trial_shape.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/base/field_violations.h"
#include "core/simulation/skin_difference.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kMillilitre = 1e-6;
/// Skin that differs by less is the same, by the tolerance of the forces [mm].
constexpr double kAgreement = 0.003;

plan::SimulationSpec make_plan(double volume) {
  plan::SimulationSpec spec = make_small_plan();
  spec.goal = plan::TimeGoal::kSettledShape;
  spec.injections[0].volume = volume;
  return spec;
}

std::unique_ptr<Simulation> run(double volume) {
  auto simulation = make_small_simulation(make_plan(volume));
  simulation->advance_step();
  EXPECT_EQ(simulation->phase(), Phase::kSettled) << simulation->reason();
  return simulation;
}

std::unique_ptr<TrialShape> make_trial() {
  auto trial = TrialShape::create(make_small_model(), make_plan(0.3 * kMillilitre));
  EXPECT_TRUE(trial.ok()) << trial.status();
  return *std::move(trial);
}

double largest_difference(const Simulation& a, const Simulation& b) {
  double largest = 0.0;
  for (const double square : squared_skin_distances(a.frame({"skin"}), b.frame({"skin"}))) {
    largest = std::max(largest, std::sqrt(square));
  }
  return largest;
}

/// Displacements of the skin [mm].
std::vector<float> skin_of(const Simulation& simulation) {
  for (const FrameField& field : simulation.frame({"skin"})) {
    if (field.name == "displacement") return field.values;
  }
  return {};
}

TEST(TrialShape, FromRestItIsTheShapeOfThePlanBitForBit) {
  const auto trial = make_trial();
  ASSERT_TRUE(trial->find({{{0, 0.5 * kMillilitre}}, {}}, true).ok());
  ASSERT_TRUE(trial->find({{{0, 0.4 * kMillilitre}}, {}}, false).ok());
  EXPECT_TRUE(trial->is_from_rest());
  EXPECT_EQ(trial->share(), 1.0);
  const auto plan = run(0.4 * kMillilitre);
  EXPECT_EQ(trial->shape().state_hash(), plan->state_hash());
  EXPECT_EQ(trial->shape().report().max_pressure, plan->report().max_pressure);
  EXPECT_EQ(trial->shape().report().film_volume, plan->report().film_volume);
}

TEST(TrialShape, FollowsTheVolumesWithinTheTolerance) {
  const auto trial = make_trial();
  for (const double volume : {0.3, 0.35, 0.4, 0.38}) {
    ASSERT_TRUE(trial->find({{{0, volume * kMillilitre}}, {}}, true).ok());
  }
  EXPECT_FALSE(trial->is_from_rest());
  EXPECT_EQ(trial->shape().report().cost.factorisations, 0) << "the factor is held";
  EXPECT_LT(largest_difference(trial->shape(), *run(0.38 * kMillilitre)), kAgreement);
  EXPECT_LT(trial->shape().report().gap_volume_relative_error, 1e-12);
}

TEST(TrialShape, WhatIsAddedIsAsIfThePlanPutItThere) {
  const auto trial = make_trial();
  const std::string zone = make_small_plan().injections[0].zone;
  ASSERT_TRUE(trial->find({{}, {{zone, 0.1 * kMillilitre}}}, false).ok());
  EXPECT_LT(largest_difference(trial->shape(), *run(0.4 * kMillilitre)), 1e-9);
  ASSERT_EQ(trial->pools().size(), 1u);
  EXPECT_NEAR(trial->pools()[0].volume, trial->shape().report().film_volume, 1e-15);
  ASSERT_TRUE(trial->find({{}, {{zone, -0.1 * kMillilitre}}}, false).ok());
  EXPECT_LT(largest_difference(trial->shape(), *run(0.2 * kMillilitre)), 1e-9);
}

TEST(TrialShape, ItsSensitivitiesAreDifferencesOfShapes) {
  const auto trial = make_trial();
  ASSERT_TRUE(trial->find({}, false).ok());
  const auto sensitivities = trial->find_sensitivities();
  ASSERT_EQ(sensitivities.size(), 1u + 2 * trial->shape().model().layers.size());
  const ShapeSensitivity& by_volume = sensitivities[0];
  EXPECT_EQ(by_volume.parameter, ShapeParameter::kPoolVolume);
  EXPECT_EQ(by_volume.name, trial->pools()[0].zones);
  const auto more = run(0.303 * kMillilitre), less = run(0.297 * kMillilitre);
  const double step = 0.006 * kMillilitre;
  const double pressure = (more->report().max_pressure - less->report().max_pressure) / step;
  EXPECT_NEAR(by_volume.pool_pressure[0], pressure, 0.02 * pressure);
  const double swept = (more->report().skin_volume_change - less->report().skin_volume_change) / step;
  EXPECT_NEAR(by_volume.skin_volume, swept, 0.02 * swept);
  const ShapeSensitivity& by_modulus = sensitivities[1];
  EXPECT_EQ(by_modulus.parameter, ShapeParameter::kLayerModulus);
  EXPECT_EQ(by_modulus.name, trial->shape().model().layers[0].name);
  EXPECT_GT(by_modulus.pool_pressure[0], 0.0) << "stiffer tissue presses more";
}

/// Against shapes of plans on models that are built thicker and thinner.
TEST(TrialShape, ItsSensitivitiesToThicknessAreDifferencesOfModels) {
  const auto trial = make_trial();
  ASSERT_TRUE(trial->find({}, false).ok());
  const auto sensitivities = trial->find_sensitivities();
  const size_t n_layers = trial->shape().model().layers.size();
  for (size_t layer = 0; layer < n_layers; ++layer) {
    SCOPED_TRACE(layer);
    const ShapeSensitivity& found = sensitivities.at(1 + n_layers + layer);
    EXPECT_EQ(found.parameter, ShapeParameter::kLayerThickness);
    const double share = 0.02;
    const auto run_with = [&](double change) {
      model::FaceModelSpec spec = make_small_model_spec();
      const double thickness = spec.layers[layer].geometry.thickness.values[0];
      spec.layers[layer].geometry.thickness = geometry::ScalarField::constant(thickness * std::exp(change));
      auto shape = TrialShape::create(*model::build_face_model(spec, nullptr), make_plan(0.3 * kMillilitre));
      EXPECT_TRUE(shape.ok() && (*shape)->find({}, false).ok());
      return *std::move(shape);
    };
    const auto thicker = run_with(share), thinner = run_with(-share);
    const double pressure = (thicker->pools()[0].head - thinner->pools()[0].head) / (2.0 * share);
    EXPECT_NEAR(found.pool_pressure[0], pressure, 0.02 * std::abs(pressure));
    const std::vector<float> more = skin_of(thicker->shape()), less = skin_of(thinner->shape());
    double largest = 0.0, off = 0.0;
    for (Eigen::Index k = 0; k < found.skin.size(); ++k) {
      const double expected = (more[static_cast<size_t>(k)] - less[static_cast<size_t>(k)]) / (2.0 * share);
      largest = std::max(largest, std::abs(expected));
      off = std::max(off, std::abs(1e3 * found.skin.reshaped()[k] - expected));
    }
    EXPECT_LT(off, 0.02 * largest);
  }
}

/// What is kept from one answer to the next changes none, down to the bits.
TEST(TrialShape, ItsSensitivitiesDoNotDependOnEarlierOnes) {
  const auto used = make_trial(), fresh = make_trial();
  ASSERT_TRUE(used->find({{{0, 0.2 * kMillilitre}}, {}}, false).ok());
  ASSERT_FALSE(used->find_sensitivities().empty());
  for (const auto* trial : {&used, &fresh}) ASSERT_TRUE((*trial)->find({}, false).ok());
  const auto again = used->find_sensitivities(), first = fresh->find_sensitivities();
  ASSERT_EQ(again.size(), first.size());
  for (size_t k = 0; k < first.size(); ++k) {
    SCOPED_TRACE(first[k].name);
    EXPECT_EQ(again[k].skin, first[k].skin);
    EXPECT_EQ(again[k].pool_pressure, first[k].pool_pressure);
  }
}

std::vector<std::string> fields_of(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : field_violations_of(status)) fields.push_back(violation.field);
  return fields;
}

TEST(TrialShape, RefusesVolumesByNameAndKeepsTheLastShape) {
  const auto trial = make_trial();
  ASSERT_TRUE(trial->find({}, false).ok());
  const std::string hash = trial->shape().state_hash();
  const TrialVolumes wrong{{{0, 1.0}, {0, 0.0}, {7, 0.0}}, {{"nowhere", 0.0}, {"nowhere", 0.0}}};
  EXPECT_THAT(fields_of(trial->find(wrong, true)),
              ElementsAre("injections[1].index", "injections[2].index", "added[1].zone"));
  EXPECT_THAT(fields_of(trial->find({{{0, 1.0}}, {{"nowhere", 0.0}}}, true)),
              ElementsAre("injections[0].volume_ml", "added[0].zone"));
  EXPECT_THAT(fields_of(trial->find({{{0, std::nan("")}}, {}}, true)), ElementsAre("injections[0].volume_ml"));
  const absl::Status overdrawn = trial->find({{{0, -1.0 * kMillilitre}}, {}}, true);
  EXPECT_EQ(overdrawn.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(overdrawn.message()), HasSubstr("more out of"));
  EXPECT_EQ(trial->shape().state_hash(), hash);
}

TEST(TrialShape, RefusesAPlanThatHasToBeStepped) {
  plan::SimulationSpec spec = make_plan(0.3 * kMillilitre);
  spec.fat_yield_stress = 20.0;
  const auto trial = TrialShape::create(make_small_model(), spec);
  ASSERT_EQ(trial.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(trial.status().message()), HasSubstr("fat.yield_stress_pa"));
}

/// A transient plan comes to the same shape: its goal does not matter here.
TEST(TrialShape, TakesTransientPlans) {
  plan::SimulationSpec spec = make_plan(0.3 * kMillilitre);
  spec.goal = plan::TimeGoal::kTransient;
  spec.settle_skin_speed = 0.0;  // it runs to its end, which comes before more could be injected
  spec.end = 0.31;
  auto trial = TrialShape::create(make_small_model(), spec);
  ASSERT_TRUE(trial.ok()) << trial.status();
  ASSERT_TRUE((*trial)->find({}, false).ok());
  EXPECT_LT(largest_difference((*trial)->shape(), *run(0.3 * kMillilitre)), 1e-9);
  ASSERT_TRUE((*trial)->find({{{0, 0.5 * kMillilitre}}, {}}, false).ok());
  EXPECT_LT(largest_difference((*trial)->shape(), *run(0.5 * kMillilitre)), 1e-9);
}

}  // namespace
}  // namespace lipofill::simulation
