#include "core/planning/proposal_bounds.h"

#include <gmock/gmock.h>

#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/planning/proposal_remainder.h"
#include "tests/unit/planning/jaw_case.h"

namespace lipofill::planning {
namespace {

using ::testing::HasSubstr;

plan::SimulationSpec make_plan() {
  plan::SimulationSpec plan;
  plan.films.resize(2);
  plan.films[0].zones = {{"cheek", geometry::ChartBox{0.1, 0.4, 0.1, 0.4}}, {"jaw", geometry::ChartBox{}}};
  plan.films[1].zones = {{"deep", geometry::ChartBox{}}};
  return plan;
}

std::string refused_field(const ProposalBounds& bounds, ZoneNumber number = ZoneNumber::kFixed) {
  const auto violations = field_violations_of(check_bounds(bounds, make_plan(), number));
  return violations.empty() ? "" : violations[0].field;
}

TEST(ProposalBounds, AdmitWhatCanBeKept) {
  ProposalBounds bounds;
  EXPECT_EQ(refused_field(bounds), "");
  bounds.each_zone = {1.0 * kMillilitre, 2.0 * kMillilitre};
  bounds.zones["deep"] = {2.0 * kMillilitre, 2.0 * kMillilitre};
  bounds.max_total = 4.0 * kMillilitre;
  EXPECT_EQ(refused_field(bounds), "") << "1 + 1 + 2 mL";
}

TEST(ProposalBounds, AreRefusedWhereTheyContradictEachOther) {
  ProposalBounds bounds;
  bounds.each_zone = {2.0 * kMillilitre, 1.5 * kMillilitre};
  EXPECT_EQ(refused_field(bounds), "bounds.max_zone_ml");
  EXPECT_THAT(std::string(check_bounds(bounds, make_plan(), ZoneNumber::kFixed).message()),
              HasSubstr("is 1.500 mL, below the least volume of each zone, 2.000 mL"));
  bounds.each_zone = {1.0 * kMillilitre, kUnbounded};
  bounds.max_total = 2.5 * kMillilitre;
  EXPECT_EQ(refused_field(bounds), "bounds.max_total_ml") << "three zones take 3 mL at least";
  EXPECT_EQ(refused_field(bounds, ZoneNumber::kSought), "") << "a proposal may have two zones";
  bounds.max_total = 0.5 * kMillilitre;
  EXPECT_EQ(refused_field(bounds, ZoneNumber::kSought), "bounds.max_total_ml") << "and one at least";
  bounds = {};
  bounds.zones["jaw"] = {1.0 * kMillilitre, 0.5 * kMillilitre};
  EXPECT_EQ(refused_field(bounds), "bounds.zone_bounds[jaw]");
  bounds.zones = {{"nose", {}}};
  EXPECT_EQ(refused_field(bounds, ZoneNumber::kSought), "bounds.zone_bounds[nose]");
}

TEST(ProposalDoubt, IsSaidOfSkinThatStaysFarFromItsTarget) {
  EXPECT_EQ(describe_doubt(0.004, 0.0019), "");
  EXPECT_THAT(describe_doubt(0.0121, 0.0104), HasSubstr("10.4 mm rms from the target (12.1 mm before)"));
}

}  // namespace
}  // namespace lipofill::planning
