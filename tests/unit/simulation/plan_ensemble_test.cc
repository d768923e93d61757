// Members of a plan's ensemble: the shapes of plans of their own, the same whoever finds them, and
// told where they fail.

#include "core/simulation/plan_ensemble.h"

#include <gmock/gmock.h>

#include "core/model/thicker_model.h"
#include "core/simulation/trial_shape.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

const Vector2d kKept(1.0, 0.5);

std::unique_ptr<PlanEnsemble> make_ensemble(int workers = 1) {
  auto ensemble = PlanEnsemble::create(make_small_model(), make_small_plan(), kKept, workers);
  EXPECT_TRUE(ensemble.ok()) << ensemble.status();
  return *std::move(ensemble);
}

PlanChange change(double modulus, double thickness, double volume, double kept) {
  return {Vector2d(modulus, 1.0), Vector2d(thickness, 1.0), VectorXd::Constant(1, volume), Vector2d(1.0, kept)};
}

std::vector<MemberResult> find(PlanEnsemble& ensemble, const std::vector<PlanChange>& changes) {
  auto found = ensemble.find(changes, nullptr);
  EXPECT_TRUE(found.ok()) << found.status();
  return *std::move(found);
}

/// The shape of a plan of its own, from rest.
TrialVolumes volume_of(double volume) {
  TrialVolumes volumes;
  volumes.injections = {{0, volume}};
  return volumes;
}

void expect_same_shape(const MemberShape& member, std::shared_ptr<const model::FaceModel> model, double volume) {
  const auto trial = *TrialShape::create(std::move(model), make_small_plan());
  ASSERT_TRUE(trial->find(volume_of(volume), false).ok());
  const Eigen::Matrix3Xd skin = trial->skin_displacement();
  const double lift = skin.colwise().norm().maxCoeff();
  EXPECT_LT((member.skin.cast<double>() - skin).colwise().norm().maxCoeff(), 3e-3 * lift);
  EXPECT_NEAR(member.max_lift, lift, 3e-3 * lift);
  const ZoneReport zone = trial->shape().zone_reports()[0];
  EXPECT_NEAR(member.pressure[0], zone.mean_pressure, 5e-3 * zone.mean_pressure);
  EXPECT_NEAR(member.volume[0], zone.volume, 1e-9 * zone.volume);
  EXPECT_NEAR(member.skin_volume, trial->shape().report().skin_volume_change, 5e-3 * member.skin_volume);
}

TEST(PlanEnsemble, MembersAreTheShapesOfTheirPlans) {
  const auto ensemble = make_ensemble();
  const auto found =
      find(*ensemble, {change(1.0, 1.0, 1.0, 0.5), change(1.3, 1.0, 0.9, 0.6), change(0.8, 1.15, 1.05, 0.4)});
  for (const MemberResult& member : found) ASSERT_EQ(member.failure, "");
  expect_same_shape(found[0].shapes[0], make_small_model(), 0.3e-6);
  expect_same_shape(found[0].shapes[1], make_small_model(), 0.15e-6);
  model::FaceModelSpec stiffer = make_small_model_spec();
  stiffer.layers[0].material.youngs_modulus *= 1.3;
  expect_same_shape(found[1].shapes[0], *model::build_face_model(stiffer, nullptr), 0.9 * 0.3e-6);
  expect_same_shape(found[1].shapes[1], *model::build_face_model(stiffer, nullptr), 0.9 * 0.6 * 0.3e-6);
  model::FaceModelSpec softer_and_thicker = make_small_model_spec();
  softer_and_thicker.layers[0].material.youngs_modulus *= 0.8;
  softer_and_thicker.layers[0].geometry.thickness = geometry::ScalarField::constant(1.15 * 2e-3);
  expect_same_shape(found[2].shapes[0], *model::build_face_model(softer_and_thicker, nullptr), 1.05 * 0.3e-6);
}

TEST(PlanEnsemble, NeitherWorkersNorNeighboursChangeAByte) {
  std::vector<PlanChange> changes;
  for (int k = 0; k < 40; ++k) changes.push_back(change(0.7 + 0.02 * k, 1.0 + 0.005 * (k % 7), 1.0, 0.4 + 0.005 * k));
  const auto one = find(*make_ensemble(1), changes);
  const auto three = find(*make_ensemble(3), changes);
  const auto alone = find(*make_ensemble(1), {changes[33]});
  ASSERT_EQ(one.size(), three.size());
  for (size_t k = 0; k < one.size(); ++k) {
    ASSERT_EQ(one[k].failure, "");
    for (size_t time = 0; time < 2; ++time) EXPECT_EQ(one[k].shapes[time].skin, three[k].shapes[time].skin) << k;
  }
  EXPECT_EQ(alone[0].shapes[1].skin, one[33].shapes[1].skin);
  EXPECT_EQ(alone[0].shapes[1].pressure, one[33].shapes[1].pressure);
}

TEST(PlanEnsemble, AMemberThatFailsIsKeptWithItsReason) {
  const auto found = find(*make_ensemble(), {change(-1.0, 1.0, 1.0, 0.5), change(1.0, 1.0, 1.0, 0.5)});
  EXPECT_NE(found[0].failure, "");
  EXPECT_TRUE(found[0].shapes.empty());
  EXPECT_EQ(found[1].failure, "");
  EXPECT_EQ(found[1].shapes.size(), 2u);
}

TEST(PlanEnsemble, StopsWhenItIsToldTo) {
  const auto ensemble = make_ensemble();
  const std::vector<PlanChange> changes(40, change(1.0, 1.0, 1.0, 0.5));
  int asked = 0;
  const auto found = ensemble->find(changes, [&](int) { return ++asked < 2; });
  EXPECT_EQ(found.status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(asked, 2);
}

TEST(PlanEnsemble, TakesAPlanWhoseRunWouldEndEarly) {
  plan::SimulationSpec plan = make_small_plan();
  plan.settle_skin_speed = 0.0;
  plan.end = 0.5;
  const auto ensemble = PlanEnsemble::create(make_small_model(), plan, kKept, 1);
  ASSERT_TRUE(ensemble.ok()) << ensemble.status();
  EXPECT_EQ((*ensemble)->nominal()[0].skin, make_ensemble()->nominal()[0].skin);
}

TEST(PlanEnsemble, RefusesAPlanThatHasToBeStepped) {
  plan::SimulationSpec plan = make_small_plan();
  plan.fat_yield_stress = 20.0;
  const auto ensemble = PlanEnsemble::create(make_small_model(), plan, kKept, 1);
  EXPECT_EQ(ensemble.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(ensemble.status().message()), ::testing::HasSubstr("yield_stress"));
}

}  // namespace
}  // namespace lipofill::simulation
