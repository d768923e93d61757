// lipofill deliver: a list of passes that adds up to the plan, and a plan that lays them.

#include <algorithm>

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class DeliverTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    write_plan("plan.json", "/name", "plate");
  }
};

TEST_F(DeliverTest, ListsPassesThatAddUpToThePlan) {
  const json delivery = answer_of("lipofill deliver plan.json --out list --spawn --json --max-pass-ml 0.05");
  double planned = 0.0;
  const json plan = read_json("plan.json");
  for (const json& injection : plan.at("simulation").at("injections")) {
    planned += injection.at("volume_ml").get<double>();
  }
  ASSERT_GT(planned, 0.0);
  double laid = 0.0;
  for (const json& pass : delivery.at("passes")) {
    EXPECT_LE(pass.at("volume_ml").get<double>(), 0.05 + 1e-12);
    laid += pass.at("volume_ml").get<double>();
  }
  EXPECT_NEAR(laid, planned, 1e-9);
  EXPECT_EQ(read_json("list/delivery.json"), delivery);

  const std::string list = read("list/passes.csv");
  EXPECT_THAT(list, HasSubstr("volume_ml,entry_x_mm"));
  EXPECT_EQ(std::count(list.begin(), list.end(), '\n'), static_cast<std::ptrdiff_t>(delivery.at("passes").size()) + 1);
}

TEST_F(DeliverTest, WritesAPlanThatRunsAndSaysHowFarItDiffers) {
  const CommandResult listed = run("lipofill deliver plan.json --out list --spawn --compare");
  EXPECT_EQ(listed.exit_code, 0) << listed.errors;
  EXPECT_THAT(listed.output, HasSubstr("entry 1 at ("));
  EXPECT_THAT(listed.output, HasSubstr("the skin differs from that of the plan by"));
  const json summary = answer_of("lipofill run list/plan.json --out out --spawn --discard --no-picture --fast --json");
  EXPECT_NEAR(summary.at("injected_ml").get<double>(), 0.3, 1e-9);
}

TEST_F(DeliverTest, RefusesWithTheOptionOrThePlansField) {
  const CommandResult pass = run("lipofill deliver plan.json --out list --spawn --quiet --max-pass-ml 0.5");
  EXPECT_EQ(pass.exit_code, 2);
  EXPECT_THAT(pass.errors, HasSubstr("--max-pass-ml: "));
  EXPECT_THAT(pass.errors, HasSubstr("0.5"));
  const CommandResult spacing = run("lipofill deliver plan.json --out list --spawn --quiet --tunnel-spacing-mm 0.1");
  EXPECT_EQ(spacing.exit_code, 2);
  EXPECT_THAT(spacing.errors, HasSubstr("--tunnel-spacing-mm: "));
  write_plan("out.json", "/simulation/injections/0/volume_ml", -0.2);
  const CommandResult negative = run("lipofill deliver out.json --out list --spawn --quiet");
  EXPECT_NE(negative.exit_code, 0);
  EXPECT_THAT(negative.errors, HasSubstr("out"));
}

}  // namespace
}  // namespace lipofill::testing
