// Films, injections and probes of a plan on a model; everything wrong at once.

#include "core/plan/plan_placement.h"

#include <gmock/gmock.h>

#include "core/base/field_violations.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using ::testing::UnorderedElementsAre;

std::vector<std::string> fields_of(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : field_violations_of(status)) fields.push_back(violation.field);
  return fields;
}

/// The small plan with a second film, whose zone lies where no cell of it is.
plan::SimulationSpec make_plan_with_unplaced_film() {
  plan::SimulationSpec spec = make_small_plan();
  spec.films.push_back(spec.films[0]);
  spec.films[1].name = "deep";
  spec.films[1].below_layer = "muscle";
  spec.films[1].extent = {0.0, 0.5, 0.0, 1.0};
  spec.films[1].n_xi = 3;
  spec.films[1].zones = {{"nowhere", geometry::ChartBox{0.8, 0.9, 0.0, 1.0}}};
  return spec;
}

TEST(PlacePlan, PlacesAllOfAGoodPlan) {
  plan::PlacedPlan placed;
  const auto model = make_small_model();
  ASSERT_TRUE(plan::place_plan(*model, make_small_plan(), nullptr, placed).ok());
  ASSERT_EQ(placed.films.size(), 1u);
  EXPECT_EQ(placed.films[0].grid.n_cells(), 36);
  ASSERT_EQ(placed.probes.size(), 1u);
  EXPECT_EQ(placed.probes[0].cell, placed.films[0].cell_at({0.55, 0.45}));
  EXPECT_DOUBLE_EQ(placed.schedule.end(), 0.3);
}

TEST(PlacePlan, TellsEverythingThatIsWrongAtOnce) {
  plan::SimulationSpec spec = make_plan_with_unplaced_film();
  spec.fat_density = -1.0;
  spec.injections[0].rate = -1e-6;
  spec.probes.push_back({"lost", "film", geometry::ChartPoint{1.5, 0.5}});
  plan::PlacedPlan placed;
  const absl::Status status = plan::place_plan(*make_small_model(), spec, nullptr, placed);
  EXPECT_THAT(fields_of(status), UnorderedElementsAre("fat.density_kg_m3", "films[1].zones[0]",
                                                      "injections[0].rate_ml_per_s", "probes[1].place"))
      << status;
  EXPECT_THAT(placed.spec_of_film, UnorderedElementsAre(0));
}

TEST(PlacePlan, LeavesOutWhatLiesInAFilmWithoutAPlace) {
  plan::SimulationSpec spec = make_plan_with_unplaced_film();
  spec.injections.push_back({"nowhere", 0.1e-6, 1e-6, std::nullopt, std::nullopt});
  spec.probes.push_back({"deep", "deep", geometry::ChartPoint{0.25, 0.5}});
  plan::PlacedPlan placed;
  const absl::Status status = plan::place_plan(*make_small_model(), spec, nullptr, placed);
  EXPECT_THAT(fields_of(status), UnorderedElementsAre("films[1].zones[0]")) << status;
}

TEST(PlacePlan, EndsOnceItIsUnwanted) {
  int asked = 0;
  plan::PlacedPlan placed;
  const absl::Status status = plan::place_plan(
      *make_small_model(), make_small_plan(), [&asked] { return ++asked > 1; }, placed);
  EXPECT_TRUE(absl::IsCancelled(status)) << status;
  EXPECT_EQ(placed.films.size(), 1u) << "it was asked between the film and the injection";
}

}  // namespace
}  // namespace lipofill::simulation
