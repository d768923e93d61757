// Each class of failure and its exit code, from the shell.

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

class BadInputTest : public CliTest {
 protected:
  void expect_failure(const std::string& line, int exit_code, const std::string& said) const {
    const CommandResult result = run(line);
    EXPECT_EQ(result.exit_code, exit_code) << line << "\n" << result.errors;
    EXPECT_THAT(result.errors, HasSubstr(said)) << line;
    EXPECT_EQ(result.output, "") << line;
  }
};

TEST_F(BadInputTest, Usage) {
  expect_failure("lipofill", 2, "subcommand");
  expect_failure("lipofill fly", 2, "there is no command 'fly'; see lipofill --help");
  expect_failure("lipofill --json fly", 2, "there is no command 'fly'; see lipofill --help");
  expect_failure("lipofill plan chek", 2,
                 "there is no command 'plan chek' (did you mean 'plan check'?); see lipofill plan --help");
  expect_failure("lipofill run plan.json", 2, "--out");
  expect_failure("lipofill run plan.json --out out --spawn --server a:1", 2, "excludes");
  expect_failure("lipofill run plan.json --out out --interval-ms -1 --spawn", 2, "--interval-ms");
  const CommandResult help = run("lipofill run --help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.output, HasSubstr("Examples:"));
  EXPECT_THAT(help.output, HasSubstr("130"));
}

TEST_F(BadInputTest, PlansThatCannotBeRead) {
  write_plan("unknown.json", "/simulation/injections/0/volume", 1.0);
  expect_failure("lipofill plan check unknown.json", 2,
                 "simulation.injections[0].volume: no such field; did you mean volume_ml?");
  expect_failure("lipofill run unknown.json --out out --spawn", 2, "did you mean volume_ml?");
  EXPECT_FALSE(exists("out"));
  write("cut.json", "{\"name\": ");
  expect_failure("lipofill plan check cut.json", 2, "cut.json is not JSON");
  expect_failure("lipofill run none.json --out out --spawn", 2, "none.json does not exist");
  expect_failure("lipofill run plan.json --out plan.json/out --spawn", 2, "cannot make the folder");
  EXPECT_EQ(run("lipofill plan check plan.json").exit_code, 0);
}

TEST_F(BadInputTest, ValuesTheDaemonRefuses) {
  write_plan("nu.json", "/model/layers/0/poisson_ratio", 0.6);
  expect_failure("lipofill run nu.json --out out --spawn --quiet", 2, "poisson_ratio");
  write_plan("zone.json", "/simulation/injections/0/zone", "elsewhere");
  expect_failure("lipofill run zone.json --out out --spawn --quiet", 2, "injections[0].zone");
  write_plan("step.json", "/simulation/time/max_injection_step_ms", 1.0);
  expect_failure("lipofill run step.json --out out --spawn --quiet", 2, "time.max_injection_step_ms");
  write_plan("goal.json", "/simulation/time/goal", "PERFECT");
  expect_failure("lipofill plan check goal.json", 2, "goal");
  write_plan("preview.json", "/simulation/preview", "perhaps");
  expect_failure("lipofill plan check preview.json", 2, "preview");
  const CommandResult result = run("lipofill run nu.json --out out --spawn --json");
  EXPECT_EQ(result.exit_code, 2);
  const size_t begin = result.errors.find("{\n");
  ASSERT_NE(begin, std::string::npos) << result.errors;
  const auto error = nlohmann::json::parse(result.errors.substr(begin))["error"];
  EXPECT_EQ(error["code"], "INVALID_ARGUMENT");
  EXPECT_THAT(error["field_violations"][0]["field"].get<std::string>(), HasSubstr("poisson_ratio"));
  EXPECT_THAT(error["field_violations"][0]["description"].get<std::string>(), HasSubstr("0.6"));
}

TEST_F(BadInputTest, NoDaemon) {
  expect_failure("lipofill health --server 127.0.0.1:1", 3,
                 "no daemon answers at 127.0.0.1:1; start lipofilld or use --spawn");
  expect_failure("env LIPOFILL_SERVER=127.0.0.1:2 lipofill patient list", 3, "127.0.0.1:2");
  expect_failure("lipofill run plan.json --out out --server 127.0.0.1:1 --quiet", 3, "no daemon answers");
}

TEST_F(BadInputTest, Volumes) {
  write("a.mha", "DimSize = 9 9 9\nElementType = MET_SHORT\nElementDataFile = LOCAL\nxyz");
  expect_failure("lipofill scan extract a.mha --out a.ply", 2, "cut short");
  expect_failure("lipofill scan extract none.mha --out a.ply", 2, "does not exist");
  write("a.inv3", "garbage");
  expect_failure("lipofill scan convert a.inv3 --out b.mha", 2, "a.inv3");
  EXPECT_FALSE(exists("a.ply"));
  EXPECT_FALSE(exists("b.mha"));
}

TEST_F(BadInputTest, PicturesOfNothing) {
  expect_failure("lipofill render .", 2, "not a folder that lipofill run has written");
  expect_failure("lipofill render . --out nowhere/sheet.png", 2,
                 "cannot write nowhere/sheet.png: nowhere: No such file");
  write("run.json", R"({"plan": "p", "simulation": "", "server": "", "data": "", "kept": false})");
  expect_failure("lipofill render .", 2, "holds no");
  write("skin_0000.vtp", "not XML");
  expect_failure("lipofill render .", 2, "cannot read the mesh");
  // A screen that is not there is not the end: xvfb-run is tried next, and it is the file that is
  // refused.
  expect_failure("env DISPLAY=:4711 lipofill render .", 2, "cannot read the mesh");
}

TEST_F(BadInputTest, NoScreenSaysWhatToInstall) {
  write("run.json", R"({"plan": "p", "simulation": "", "server": "", "data": "", "kept": false})");
  // Only the folder of lipofill on the path: no xvfb-run.
  expect_failure("env PATH=" LIPOFILL_BIN " lipofill render .", 4, "apt-get install xvfb");
}

}  // namespace
}  // namespace lipofill::testing
