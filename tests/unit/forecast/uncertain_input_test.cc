// What is uncertain of a plan by default, and what may be put in its place.

#include "core/forecast/uncertain_input.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::forecast {
namespace {

using ::testing::HasSubstr;

struct InputCase {
  std::shared_ptr<const model::FaceModel> model = simulation::make_small_model();
  plan::SimulationSpec plan = simulation::make_small_plan();

  absl::StatusOr<std::vector<UncertainInput>> choose(const std::vector<UncertainInput>& given, bool only = false) {
    return choose_inputs(model->layers, plan, given, only);
  }
  std::string refusal(const std::vector<UncertainInput>& given) {
    return std::string(choose(given).status().message());
  }
};

TEST(UncertainInput, DefaultsHaveTheirSourcesAndAreWhatIsPublished) {
  InputCase c;
  const auto inputs = default_inputs(c.model->layers, c.plan);
  ASSERT_EQ(inputs.size(), 7u) << "two layers twice, a zone, two directions";
  EXPECT_EQ(inputs[0].describe(), "the stiffness of the layer skin");
  EXPECT_NEAR(inputs[0].distribution.spread, std::log(500.0 / 90.0) / 4.0, 1e-12);
  EXPECT_NEAR(inputs[2].distribution.spread, std::log(2.0 / 1.5) / 4.0, 1e-12);
  EXPECT_FALSE(inputs[0].is_assumed);
  EXPECT_TRUE(inputs[4].is_assumed);
  for (const UncertainInput& input : inputs) EXPECT_FALSE(input.source.empty());
  EXPECT_TRUE(c.choose(inputs).ok()) << "defaults are possible";
}

TEST(UncertainInput, WhatIsGivenTakesThePlaceOfItsDefault) {
  InputCase c;
  const UncertainInput stiff{Quantity::kLayerModulus, "muscle", Distribution::log_normal(2.0, 0.1), "mine", false};
  const auto chosen = c.choose({stiff});
  ASSERT_TRUE(chosen.ok());
  EXPECT_EQ(chosen->size(), 7u);
  EXPECT_EQ((*chosen)[1].source, "mine");
  EXPECT_EQ(c.choose({stiff}, true)->size(), 1u);
}

TEST(UncertainInput, RefusesWhatIsNotPossible) {
  InputCase c;
  const auto input = [](Quantity quantity, const std::string& name, double low, double high) {
    return UncertainInput{quantity, name, {Law::kUniform, 0.0, 0.0, low, high}, "", false};
  };
  EXPECT_THAT(c.refusal({input(Quantity::kLayerModulus, "skin", 1e-6, 1.0)}),
              HasSubstr("inputs[0].distribution.low: is 1e-06 times 100 kPa: less than 0.001 times 100 kPa"));
  EXPECT_THAT(c.refusal({input(Quantity::kLayerThickness, "skin", 0.1, 1.0)}), HasSubstr("is not possible"));
  EXPECT_THAT(c.refusal({input(Quantity::kZoneVolume, "all", -0.5, 1.0)}), HasSubstr("less than 0 times the volume"));
  EXPECT_THAT(c.refusal({input(Quantity::kPlaceXi, "", -0.02, 0.0)}), HasSubstr("is -20 mm: less than -10 mm"));
  EXPECT_THAT(c.refusal({input(Quantity::kLayerModulus, "bone", 0.5, 1.0)}), HasSubstr("no layer of that name"));
  EXPECT_THAT(c.refusal({input(Quantity::kZoneVolume, "nose", 0.5, 1.0)}), HasSubstr("no injection into a zone"));
  EXPECT_THAT(c.refusal({input(Quantity::kRetention, "", 0.5, 1.0)}), HasSubstr("the field retention sets"));
  const auto twice = input(Quantity::kLayerModulus, "skin", 0.5, 1.5);
  EXPECT_THAT(c.refusal({twice, twice}), HasSubstr("inputs[1]: is about the stiffness of the layer skin again"));
}

}  // namespace
}  // namespace lipofill::forecast
