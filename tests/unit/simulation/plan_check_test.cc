// What is said of a plan on a model without a simulation of it.

#include "core/simulation/plan_check.h"

#include <gmock/gmock.h>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

PlanCheck check(const plan::SimulationSpec& spec) {
  const auto found = check_plan_on_model(*make_small_model(), spec, nullptr);
  EXPECT_TRUE(found.ok()) << found.status();
  return found.ok() ? *found : PlanCheck{};
}

/// Two zones side by side, three by six and three by four cells of 8 mm.
plan::SimulationSpec make_two_zones() {
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].zones = {{"left", geometry::ChartBox{0.0, 0.5, 0.0, 1.0}},
                         {"right", geometry::ChartBox{0.5, 1.0, 0.0, 2.0 / 3.0}}};
  spec.injections[0].zone = "right";
  return spec;
}

TEST(CheckPlan, FindsZonesWhereTheSimulationHasThem) {
  const plan::SimulationSpec spec = make_two_zones();
  const PlanCheck found = check(spec);
  EXPECT_THAT(found.violations, IsEmpty());
  EXPECT_THAT(found.remarks, IsEmpty());
  ASSERT_EQ(found.zones.size(), 2u);
  EXPECT_EQ(found.zones[1].number, 2);
  EXPECT_EQ(found.zones[1].film, "film");
  EXPECT_EQ(found.zones[1].name, "right");
  EXPECT_EQ(found.zones[1].n_cells, 12);
  EXPECT_NEAR(found.zones[0].area, 0.024 * 0.048, 1e-12);
  EXPECT_NEAR(found.zones[1].area, 0.024 * 0.032, 1e-12);
  ASSERT_EQ(found.zones[1].outline.size(), 1u);
  EXPECT_NEAR(found.zones[1].outline[0].row(0).minCoeff(), 0.024, 1e-12);
  EXPECT_NEAR(found.zones[1].outline[0].row(0).maxCoeff(), 0.048, 1e-12);

  const auto simulation = make_small_simulation(spec);
  std::vector<int> shown;
  for (const FrameField& field : simulation->frame({"skin"})) {
    if (field.name == "zone") shown.assign(field.values.begin(), field.values.end());
  }
  EXPECT_EQ(found.zone_under_skin, shown);
}

TEST(CheckPlan, NumbersZonesAsThePlanDoesWhenAFilmHasNoPlace) {
  plan::SimulationSpec spec = make_two_zones();
  spec.films.insert(spec.films.begin(), spec.films[0]);
  spec.films[0].name = "broken";
  spec.films[0].below_layer = "no such layer";
  spec.films[0].zones.pop_back();
  spec.films[0].zones[0].name = "lost";
  const PlanCheck found = check(spec);
  EXPECT_THAT(found.violations, ElementsAre(Field(&FieldViolation::field, "films[0].below_layer")));
  EXPECT_THAT(found.zones, ElementsAre(Field(&PlacedZone::number, 2), Field(&PlacedZone::number, 3)));
  EXPECT_EQ(found.zone_under_skin[0], 2);
}

TEST(CheckPlan, RemarksOnInjectionsThatComeToNothing) {
  plan::SimulationSpec spec = make_two_zones();
  spec.end = 0.2;
  EXPECT_THAT(check(spec).remarks,
              ElementsAre(::testing::AllOf(Field(&FieldViolation::field, "time.end_s"),
                                           Field(&FieldViolation::description, HasSubstr("injections end at 0.3 s")))));
  spec.injections.clear();
  EXPECT_THAT(check(spec).remarks, ElementsAre(Field(&FieldViolation::field, "injections")));
}

TEST(CheckPlan, RemarksOnZonesThatAreAllEdge) {
  plan::SimulationSpec spec = make_two_zones();
  spec.films[0].zones[1].shape = geometry::ChartBox{0.5, 1.0, 0.0, 1.0 / 3.0};
  spec.injections[0].site.reset();
  spec.probes.clear();
  const PlanCheck found = check(spec);
  EXPECT_THAT(found.violations, IsEmpty());
  EXPECT_THAT(found.remarks, ElementsAre(Field(&FieldViolation::field, "films[0].zones[1]")));
}

TEST(CheckPlan, EndsOnceItIsUnwanted) {
  const auto found = check_plan_on_model(*make_small_model(), make_small_plan(), [] { return true; });
  EXPECT_TRUE(absl::IsCancelled(found.status())) << found.status();
}

}  // namespace
}  // namespace lipofill::simulation
