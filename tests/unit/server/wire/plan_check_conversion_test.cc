// The answer about a plan, and its bounds.

#include "server/wire/plan_check_conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

simulation::PlacedZone zone_with_outline(int number, Eigen::Index points) {
  return {number, "film", "middle", 9, 3e-4, {Eigen::Matrix3Xd::Constant(3, points, 2e-3)}};
}

TEST(CheckPlanResponse, HasTheUnitsAndFieldsOfTheWire) {
  simulation::PlanCheck check;
  check.violations = {{"films[0].n_xi", "is 0"}, {"", "is missing"}};
  check.remarks = {{"injections", "there are none"}};
  check.zones = {zone_with_outline(2, 4)};
  check.zone_under_skin = {0, 2, 2};
  const v1::CheckPlanResponse response = to_check_plan_response(check);
  ASSERT_EQ(response.violations_size(), 2);
  EXPECT_EQ(response.violations(0).field(), "spec.films[0].n_xi");
  EXPECT_EQ(response.violations(0).description(), "is 0");
  EXPECT_EQ(response.violations(1).field(), "spec");
  EXPECT_EQ(response.remarks(0).field(), "spec.injections");
  ASSERT_EQ(response.zones_size(), 1);
  EXPECT_EQ(response.zones(0).number(), 2u);
  EXPECT_EQ(response.zones(0).film_cells(), 9u);
  EXPECT_DOUBLE_EQ(response.zones(0).area_cm2(), 3.0);
  EXPECT_EQ(response.zones(0).outline(0).points_mm_size(), 4);
  EXPECT_DOUBLE_EQ(response.zones(0).outline(0).points_mm(3).z(), 2.0);
  EXPECT_THAT(response.zone_under_skin_point(), ::testing::ElementsAre(0, 2, 2));
}

TEST(CheckPlanResponse, IsBoundedWhateverThePlan) {
  simulation::PlanCheck check;
  check.violations.assign(5000, {"films[0]", "is wrong"});
  check.remarks = check.violations;
  check.zones = {zone_with_outline(1, 15'000), zone_with_outline(2, 15'000), zone_with_outline(3, 5'000)};
  const v1::CheckPlanResponse response = to_check_plan_response(check);
  EXPECT_EQ(response.violations_size(), 200);
  EXPECT_EQ(response.remarks_size(), 200);
  EXPECT_EQ(response.zones(0).outline_size(), 1);
  EXPECT_EQ(response.zones(1).outline_size(), 0) << "there is no room left for it";
  EXPECT_EQ(response.zones(2).outline_size(), 1);
  EXPECT_LT(response.ByteSizeLong(), 1u << 20);
}

}  // namespace
}  // namespace lipofill::server
