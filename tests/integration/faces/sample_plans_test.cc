// Every sample plan is accepted and starts well: each runs for a quarter of a simulated second by
// one command.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using nlohmann::json;

/// Names of the plans that bring all they need; others read a scan that is not shipped.
std::vector<std::string> find_plans() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(LIPOFILL_PLANS)) {
    std::ifstream file(entry.path());
    const json plan = json::parse(file, nullptr, false);
    if (!plan.is_object() || !plan.contains("simulation")) continue;
    if (plan.contains("parts")) continue;  // see several_parts_test.cc
    const std::string scan = plan.value("/scan/file"_json_pointer, std::string());
    if (scan.empty() && plan.contains("/model/scan_region"_json_pointer)) continue;
    if (!scan.empty() && !std::filesystem::exists(entry.path().parent_path() / scan)) continue;
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class SamplePlan : public CliTest, public ::testing::WithParamInterface<std::string> {};

TEST_P(SamplePlan, Starts) {
  const std::filesystem::path plans = LIPOFILL_PLANS;
  std::ifstream file(plans / (GetParam() + ".json"));
  json plan = json::parse(file);
  for (const char* name : {"/scan/file", "/scan/landmarks_file"}) {
    const json::json_pointer pointer(name);
    if (plan.contains(pointer)) plan[pointer] = (plans / plan[pointer].get<std::string>()).string();
  }
  plan["simulation"]["time"]["end_s"] = 0.25;
  write("short.json", plan.dump());
  const CommandResult result = run("lipofill run short.json --out out --spawn --discard --quiet --no-picture --json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json summary = json::parse(result.output, nullptr, false);
  ASSERT_TRUE(summary.is_object()) << result.output;
  EXPECT_EQ(summary.at("state"), "FINISHED") << summary.at("reason");
  EXPECT_LT(summary.at("film_volume_relative_error").get<double>(), 1e-10);
  EXPECT_LT(summary.at("gap_volume_relative_error").get<double>(), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Every, SamplePlan, ::testing::ValuesIn(find_plans()),
                         [](const auto& plan) { return plan.param; });

}  // namespace
}  // namespace lipofill::testing
