// Injection lists: every zone is covered, no pass lays too much, the volumes are the plan's, and
// the plan as given comes to the plan's shape where fat flows.

#include "core/planning/delivery.h"

#include <gmock/gmock.h>

#include <map>

#include "core/simulation/simulation.h"
#include "tests/unit/planning/square_case.h"

namespace lipofill::planning {
namespace {

using ::testing::HasSubstr;

TEST(Delivery, LaysThePlansVolumesInSmallPasses) {
  const auto model = make_square();
  const auto delivery = make_delivery(*model, make_square_plan(1.0 * kMillilitre, 0.55 * kMillilitre), {});
  ASSERT_TRUE(delivery.ok()) << delivery.status();
  ASSERT_EQ(delivery->entries.size(), 2u);
  std::map<std::string, double> volumes;
  std::vector<int> passes(2, 0);
  for (const CannulaPass& pass : delivery->passes) {
    EXPECT_LE(pass.volume, 0.1 * kMillilitre * (1.0 + 1e-9));
    ++passes[static_cast<size_t>(pass.entry)];
    const Eigen::Vector3d entry = delivery->entries[static_cast<size_t>(pass.entry)].position;
    for (Eigen::Index k = 1; k < pass.positions.cols(); ++k) {
      EXPECT_LT((pass.positions.col(k) - entry).norm(), (pass.positions.col(k - 1) - entry).norm())
          << "fat is laid while the cannula is drawn back";
    }
  }
  for (const plan::InjectionSpec& injection : delivery->plan_as_given.injections) {
    volumes[injection.zone] += injection.volume;
  }
  EXPECT_NEAR(volumes["left"], 1.0 * kMillilitre, 1e-12 * kMillilitre);
  EXPECT_NEAR(volumes["right"], 0.55 * kMillilitre, 1e-12 * kMillilitre);
  EXPECT_EQ(delivery->entries[0].passes, passes[0]);
  EXPECT_GE(passes[0], 10);
  // Of two cells as large, none has more than twice what the other has, wherever they lie.
  std::map<std::pair<double, double>, double> at;
  for (const plan::InjectionSpec& injection : delivery->plan_as_given.injections) {
    const auto& site = std::get<geometry::ChartPoint>(*injection.site);
    if (injection.zone == "left") at[{site.xi, site.eta}] += injection.volume;
  }
  EXPECT_GE(at.size(), 12u) << "the whole zone is served";
}

TEST(Delivery, TheEntryLiesBesideItsZone) {
  const auto model = make_square();
  const auto delivery = make_delivery(*model, make_square_plan(0.5 * kMillilitre, 0.5 * kMillilitre), {});
  ASSERT_TRUE(delivery.ok()) << delivery.status();
  const geometry::ChartPoint& place = delivery->entries[0].place;
  EXPECT_EQ(delivery->entries[0].zone, "left");
  EXPECT_LT(place.eta, 0.2) << "below the zone, which is longer upwards";
}

TEST(Delivery, FatThatFlowsComesToThePlansShape) {
  const auto model = make_square();
  const plan::SimulationSpec plan = make_square_plan(0.5 * kMillilitre, 0.25 * kMillilitre);
  const auto delivery = make_delivery(*model, plan, {});
  ASSERT_TRUE(delivery.ok()) << delivery.status();
  const auto difference = compare_settled(model, plan, *delivery, nullptr);
  ASSERT_TRUE(difference.ok()) << difference.status();
  EXPECT_LT(difference->max, 0.003 * kMillimetre);
}

/// A yield stress keeps fat where it is laid: the plan as given is another shape.
TEST(Delivery, FatWithAYieldStressStaysWhereItIsLaid) {
  const auto model = simulation::make_small_model();
  plan::SimulationSpec plan = simulation::make_small_plan();
  plan.goal = plan::TimeGoal::kSettledShape;
  plan.fat_yield_stress = 200.0;
  plan.injections[0].volume = 0.2 * kMillilitre;
  const auto delivery = make_delivery(*model, plan, {});
  ASSERT_TRUE(delivery.ok()) << delivery.status();
  EXPECT_THAT(std::string(compare_settled(model, plan, *delivery, nullptr).status().message()),
              HasSubstr("fat.yield_stress_pa"));
  const auto difference = compare_delivery(model, plan, *delivery, nullptr);
  ASSERT_TRUE(difference.ok()) << difference.status();
  EXPECT_GT(difference->max, 0.01 * kMillimetre);
}

TEST(Delivery, RefusesWhatHasNoList) {
  const auto model = make_square();
  plan::SimulationSpec plan = make_square_plan(0.0, 0.0);
  EXPECT_THAT(std::string(make_delivery(*model, plan, {}).status().message()), HasSubstr("injects nothing"));
  plan = make_square_plan(-0.01 * kMillilitre, 0.5 * kMillilitre);
  EXPECT_THAT(std::string(make_delivery(*model, plan, {}).status().message()), HasSubstr("out of zone 'left'"));
  plan = make_square_plan(2.0 * kMillilitre, 0.5 * kMillilitre);
  EXPECT_THAT(std::string(make_delivery(*model, plan, {0.001 * kMillilitre, 5e-3}).status().message()),
              HasSubstr("more than the 1000 injections"));
}

}  // namespace
}  // namespace lipofill::planning
