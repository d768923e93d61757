// Plans that hold where the tissue is softer or stiffer: the draws, and what holding costs.

#include "core/planning/robust.h"

#include <gmock/gmock.h>

#include "tests/unit/planning/square_case.h"

namespace lipofill::planning {
namespace {

using ::testing::HasSubstr;

TEST(Robust, DrawsFillTheDistributionEvenly) {
  const auto moduli = draw_moduli(3, 200, 0.2);
  ASSERT_EQ(moduli.size(), 200u);
  for (int layer = 0; layer < 3; ++layer) {
    Eigen::VectorXd logs(200);
    for (int k = 0; k < 200; ++k) logs[k] = std::log(moduli[static_cast<size_t>(k)][layer]);
    EXPECT_NEAR(logs.mean(), 0.0, 1e-9);
    EXPECT_NEAR(std::sqrt(logs.squaredNorm() / 200.0), 0.2, 0.002);
    EXPECT_NEAR(quantile_of(logs, 0.975), 1.96 * 0.2, 0.01);
  }
  double together = 0.0;
  for (const auto& member : moduli) together += std::log(member[0]) * std::log(member[1]);
  EXPECT_LT(std::abs(together / 200.0), 0.15 * 0.2 * 0.2) << "layers are on their own";
  EXPECT_EQ(draw_moduli(3, 200, 0.2)[17], moduli[17]);
}

TEST(Robust, TheQuantileIsNotExceededByItsShare) {
  Eigen::VectorXd values(20);
  for (int k = 0; k < 20; ++k) values[k] = 20 - k;
  EXPECT_EQ(quantile_of(values, 0.95), 19.0);
  EXPECT_EQ(quantile_of(values, 0.5), 10.0);
  EXPECT_EQ(quantile_of(values, 1.0), 20.0);
}

TEST(Robust, HoldsInNinetyFiveOfAHundredAtACost) {
  SquareCase c;
  const Proposal free = c.propose();
  c.request.spread = TissueSpread{free.max_pressure(), 0.95, 100, 0.2};
  const Proposal held = c.propose();
  ASSERT_TRUE(held.robustness.has_value());
  EXPECT_GE(held.robustness->members_below, 95);
  EXPECT_LE(held.robustness->members_below, 97) << "it gives no more away than it has to";
  EXPECT_NEAR(held.robustness->nominal_members_below, 50, 15);
  EXPECT_LT(held.total(), free.total());
  EXPECT_GT(held.reached.skin_to_target.rms, held.nominal_rms);
  EXPECT_EQ(held.robustness->nominal.total(), free.total());
}

/// Each member by itself: the plan's own simulation on a model of that tissue. A member's pressure
/// is the nominal mean over the zone with the change of its pool's pressure, which is not quite the
/// mean.
TEST(Robust, MembersHaveThePressuresOfTheirOwnPlans) {
  const SquareCase c;
  const auto moduli = draw_moduli(2, 20, 0.2);
  auto trial = simulation::TrialShape::create(c.model, make_square_plan(0.4 * kMillilitre, 0.2 * kMillilitre));
  ASSERT_TRUE(trial.ok() && (*trial)->find({}, false).ok());
  const auto pressures = (*trial)->find_member_pressures(moduli, nullptr);
  ASSERT_TRUE(pressures.ok()) << pressures.status();
  for (const int k : {0, 7, 19}) {
    auto other = std::make_shared<model::FaceModel>(*c.model);
    for (size_t layer = 0; layer < 2; ++layer) {
      other->layers[layer].material.youngs_modulus *= moduli[static_cast<size_t>(k)][static_cast<Eigen::Index>(layer)];
    }
    other->shared = model::make_shared_parts();
    auto alone = simulation::TrialShape::create(other, make_square_plan(0.4 * kMillilitre, 0.2 * kMillilitre));
    ASSERT_TRUE(alone.ok() && (*alone)->find({}, false).ok());
    const auto zones = (*alone)->shape().zone_reports();
    for (const Eigen::Index zone : {0, 1}) {
      const double expected = zones[static_cast<size_t>(zone)].mean_pressure;
      EXPECT_NEAR((*pressures)(zone, k), expected, 0.05 * expected);
    }
  }
}

TEST(Robust, RefusesABandThatNothingKeepsTo) {
  SquareCase c;
  c.request.spread = TissueSpread{5.0, 0.95, 20, 0.2};
  c.request.bounds.each_zone.low = 0.2 * kMillilitre;
  EXPECT_EQ(c.refusal().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(c.refusal().message()), HasSubstr("kPa"));
}

}  // namespace
}  // namespace lipofill::planning
