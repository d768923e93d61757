// lipofill propose: a plan file that runs to the shape the proposal tells of; what it refuses.

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class ProposeTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    write_plan("plan.json", "/name", "plate");
    write_plane("goal.obj", 1.5);
  }
};

TEST_F(ProposeTest, WritesAPlanThatRunsToItsShape) {
  const json proposal =
      answer_of("lipofill propose plan.json --target goal.obj --out proposed --spawn --json --curve-points 3");
  ASSERT_EQ(proposal.at("volumes").size(), 1u);
  EXPECT_GT(proposal.at("total_ml").get<double>(), 0.3);
  EXPECT_LT(proposal.at("reached").at("skin_to_target").at("rms_mm").get<double>(),
            proposal.at("before").at("skin_to_target").at("rms_mm").get<double>());
  EXPECT_EQ(read_json("proposed/proposal.json"), proposal);
  EXPECT_FALSE(exists("proposed/.lipofilld"));
  const json summary = answer_of("lipofill run proposed/plan.json --out out --spawn --discard --no-picture --json");
  EXPECT_EQ(summary.at("state"), "SETTLED");
  EXPECT_EQ(summary.at("state_hash"), proposal.at("state_hash"));
}

TEST_F(ProposeTest, KeepsToBoundsAndTellsPeople) {
  const CommandResult result =
      run("lipofill propose plan.json --target goal.obj --out proposed --spawn --max-total-ml 0.3 --curve-points 1");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("0.300 mL in 1 zone\n"));
  EXPECT_THAT(result.output, HasSubstr("held by the largest total volume"));
  EXPECT_THAT(result.output, HasSubstr("the largest total volume holds the volume"));
  EXPECT_THAT(result.errors, HasSubstr("proposing"));
}

TEST_F(ProposeTest, RefusesWithFigures) {
  write_plane("below.obj", -1.0);
  const CommandResult below = run("lipofill propose plan.json --target below.obj --out proposed --spawn --quiet");
  EXPECT_NE(below.exit_code, 0);
  EXPECT_THAT(below.errors, HasSubstr("the target lies everywhere below the skin"));
  write_plane("same.obj", 0.0);
  const CommandResult same = run("lipofill propose plan.json --target same.obj --out proposed --spawn --quiet");
  EXPECT_THAT(same.errors, HasSubstr("nothing is missing: the target is the skin as it is"));
  const CommandResult none = run("lipofill propose plan.json --target none.obj --out proposed --spawn");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_EQ(none.errors, "lipofill: --target: none.obj does not exist or is not a file\n") << "before anything is made";
  const CommandResult bound = run(
      "lipofill propose plan.json --target goal.obj --out proposed --spawn --quiet --min-zone-ml 2 --max-zone-ml 1");
  EXPECT_EQ(bound.exit_code, 2);
  EXPECT_THAT(bound.errors, HasSubstr("--max-zone-ml: is 1.000 mL, below the least volume of each zone, 2.000 mL"));
}

}  // namespace
}  // namespace lipofill::testing
