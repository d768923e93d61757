// lipofill forecast and lipofill retention: files, sentences, and what they refuse.

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class ForecastCliTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    write_plan("plan.json", "/name", "plate");
  }
};

TEST_F(ForecastCliTest, WritesWhatIsKnown) {
  const json made = answer_of("lipofill forecast plan.json --out known --spawn --json --members 60 --month 12");
  EXPECT_EQ(made.at("members"), 60);
  EXPECT_EQ(made.at("times").size(), 2u);
  EXPECT_EQ(read_json("known/forecast.json"), made);
  EXPECT_FALSE(exists("known/.lipofilld"));
}

TEST_F(ForecastCliTest, TellsPeople) {
  const CommandResult result = run(
      "lipofill forecast plan.json --out known --spawn --members 60 --month 3 --figures-only --retention centrifuge");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("60 of 60 members settled"));
  EXPECT_THAT(result.output, HasSubstr("pressure bands"));
  EXPECT_THAT(result.output, HasSubstr("comes mostly from"));
  EXPECT_THAT(result.output, HasSubstr("prepared in a centrifuge"));
  EXPECT_THAT(result.output, HasSubstr("session 1, month 0"));
  EXPECT_THAT(result.errors, HasSubstr("forecasting"));
}

TEST_F(ForecastCliTest, RefusesWithFigures) {
  const CommandResult many = run("lipofill forecast plan.json --out known --spawn --quiet --members 20000");
  EXPECT_EQ(many.exit_code, 2);
  EXPECT_THAT(many.errors, HasSubstr("--members: is 20000, must be in [50, 10000]"));
  const CommandResult preset = run("lipofill forecast plan.json --out known --spawn --quiet --retention magic");
  EXPECT_EQ(preset.exit_code, 2);
  EXPECT_THAT(preset.errors, HasSubstr("magic"));
}

}  // namespace
}  // namespace lipofill::testing
