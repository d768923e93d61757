// Bounds on the figures of an evaluation.

#include "client/cpp/requirement.h"

#include <gmock/gmock.h>

#include "client/cpp/errors.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

v1::Evaluation make_evaluation() {
  v1::Evaluation evaluation;
  evaluation.mutable_simulated_to_target()->set_p95_mm(1.5);
  evaluation.mutable_simulated_to_target()->set_signed_mean_mm(-0.2);
  evaluation.mutable_target_to_simulated()->set_max_mm(4.0);
  evaluation.set_hausdorff_mm(4.5);
  evaluation.mutable_volume_simulated()->set_deficit_ml(0.3);
  v1::ZoneComparison& zone = *evaluation.add_zones();
  zone.set_zone("masseter");
  zone.mutable_simulated()->mutable_skin_to_target()->set_p95_mm(0.8);
  return evaluation;
}

bool is_met(const std::string& text) {
  const auto requirements = read_requirements({text});
  EXPECT_TRUE(requirements.ok()) << requirements.status();
  return requirements->at(0).is_met(requirements->at(0).figure_of(make_evaluation()));
}

TEST(Requirement, HoldsAFigureToItsBound) {
  EXPECT_TRUE(is_met("p95_mm<=1.5"));
  EXPECT_FALSE(is_met("p95_mm<=1.4"));
  EXPECT_TRUE(is_met("signed_mean_mm>=-0.5"));
  EXPECT_FALSE(is_met("signed_mean_mm>=0"));
  EXPECT_TRUE(is_met("simulated_to_target.p95_mm<=2"));
  EXPECT_TRUE(is_met("target_to_simulated.max_mm<=4"));
  EXPECT_FALSE(is_met("hausdorff_mm<=4"));
  EXPECT_TRUE(is_met("volume_simulated.deficit_ml<=0.5"));
}

TEST(Requirement, ReachesIntoZonesByName) {
  EXPECT_TRUE(is_met("zones.masseter.simulated.skin_to_target.p95_mm<=0.8"));
  EXPECT_FALSE(is_met("zones.masseter.simulated.skin_to_target.p95_mm<=0.7"));
  EXPECT_FALSE(is_met("zones.temple.simulated.skin_to_target.p95_mm<=9")) << "there is no such zone";
  EXPECT_FALSE(read_requirements({"zones.masseter.p95_mm<=1"}).ok());
}

TEST(Requirement, AFigureThatIsNotThereMeetsNothing) {
  EXPECT_FALSE(is_met("target_to_simulated.signed_mean_mm<=100"));
  EXPECT_FALSE(is_met("target_to_simulated.signed_mean_mm>=-100"));
}

TEST(Requirement, SaysWhatThereIs) {
  for (const char* text : {"p95_mm", "p95_mm<2", "p95_mm=2", "<=2", "p95_mm<=two", ""}) {
    EXPECT_TRUE(absl::IsInvalidArgument(read_requirements({text}).status())) << text;
  }
  const auto unknown = read_requirements({"p95<=2"});
  const auto violations = error_details_of(unknown.status()).violations;
  ASSERT_EQ(violations.size(), 1u);
  EXPECT_EQ(violations[0].field, "--require");
  EXPECT_THAT(violations[0].description, HasSubstr("simulated_to_target.p95_mm"));
}

}  // namespace
}  // namespace lipofill::client
