// Every command against one daemon that runs all the while, and after its restart.

#include <memory>
#include <sstream>

#include "tests/integration/cli/cli_fixture.h"
#include "tests/integration/service/daemon_process.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

class CommandsTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    start();
  }
  void start() { daemon_ = std::make_unique<DaemonProcess>((folder_ / "data").string()); }

  /// A command with the daemon's address.
  std::string to_daemon(const std::string& command) const {
    return "env LIPOFILL_SERVER=" + daemon_->address() + " lipofill " + command;
  }
  nlohmann::json ask(const std::string& command) const { return answer_of(to_daemon(command)); }
  CommandResult tell(const std::string& command) const { return run(to_daemon(command)); }

  std::unique_ptr<DaemonProcess> daemon_;
};

TEST_F(CommandsTest, Patients) {
  EXPECT_EQ(ask("health")["status"], "SERVING");
  EXPECT_EQ(ask("patient create --id case-7 --display-name left-side --label side=left")["name"], "patients/case-7");
  EXPECT_EQ(ask("patient get case-7")["labels"]["side"], "left");
  EXPECT_EQ(ask("patient update case-7 --label session=2")["labels"]["side"], "left");
  EXPECT_EQ(ask("patient update case-7 --display-name other")["display_name"], "other");
  EXPECT_EQ(ask("patient list")["patients"].size(), 1u);
  EXPECT_EQ(tell("patient create --id case-7").exit_code, 4);
  EXPECT_EQ(tell("patient create --label broken").exit_code, 2);
  EXPECT_EQ(tell("patient create --id UPPER").exit_code, 2);
  ask("patient delete case-7");
  EXPECT_EQ(tell("patient get case-7").exit_code, 4);
  EXPECT_THAT(tell("patient list").output, ::testing::IsEmpty());
}

TEST_F(CommandsTest, Scans) {
  ask("patient create --id p");
  write_plane("plane.obj", 0.0);
  const auto scan = ask("scan upload p plane.obj");
  EXPECT_EQ(scan["complete"], true);
  EXPECT_EQ(scan["report"]["vertices"], 81);
  EXPECT_NEAR(scan["report"]["size_x_mm"].get<double>(), 40.0, 1e-3);
  const std::string name = scan["name"];
  // The same bytes again are the same scan.
  EXPECT_EQ(ask("scan upload p plane.obj")["name"], name);
  EXPECT_EQ(ask("scan get " + name)["sha256"], scan["sha256"]);
  EXPECT_EQ(ask("scan list p")["scans"].size(), 1u);
  write("bad.obj", "v 0 0 nan\nf 1 2 3\n");
  const CommandResult refused = tell("scan upload p bad.obj");
  EXPECT_EQ(refused.exit_code, 2) << refused.errors;
  EXPECT_EQ(tell("patient delete p").exit_code, 4);
  ask("scan delete " + name);
  EXPECT_EQ(tell("scan get " + name).exit_code, 4);
}

TEST_F(CommandsTest, ModelAndSimulationStepByStep) {
  ask("patient create --id p");
  const auto model = ask("model build p plan.json");
  const std::string model_name = model["name"];
  EXPECT_EQ(model["report"]["hexahedra"], 144);
  EXPECT_EQ(ask("model get " + model_name)["report"]["content_hash"], model["report"]["content_hash"]);
  EXPECT_EQ(ask("model list p")["models"].size(), 1u);
  EXPECT_GE(ask("operation list")["operations"].size(), 1u);
  ask("model mesh " + model_name + " --out rest");
  EXPECT_TRUE(exists("rest/skin_0000.vtp"));
  EXPECT_TRUE(exists("rest/tissue_0000.vtu"));

  write_plan("long.json", "/simulation/time/end_s", 100000.0);
  const auto simulation = ask("simulation create long.json --id s --model " + model_name);
  EXPECT_EQ(simulation["state"], "READY");
  EXPECT_EQ(tell("export s --out early").exit_code, 4);
  EXPECT_EQ(tell("export s").exit_code, 2);
  // A deck does not wait for the end.
  ask("export s --deck early.inp");
  EXPECT_THAT(read("early.inp"), ::testing::EndsWith("*END STEP\n"));
  EXPECT_FALSE(exists("early.inp.part"));
  EXPECT_EQ(tell("export s --deck no/such/folder/deck.inp").exit_code, 2);
  EXPECT_EQ(tell("export none --deck none.inp").exit_code, 4);
  EXPECT_FALSE(exists("none.inp") || exists("none.inp.part"));
  EXPECT_EQ(ask("simulation start s")["state"], "RUNNING");
  // 64-bit numbers are strings in the JSON of proto3.
  for (int i = 0; i < 200 && ask("simulation get s")["summary"]["steps"] == "0"; ++i) continue;
  EXPECT_EQ(ask("simulation pause s")["state"], "PAUSED");
  EXPECT_EQ(ask("simulation inject s --zone middle --volume-ml 0.1 --rate-ml-per-s 1")["spec"]["injections"].size(),
            2u);
  EXPECT_EQ(ask("simulation resume s")["state"], "RUNNING");
  EXPECT_EQ(ask("simulation stop s")["state"], "STOPPED");
  EXPECT_EQ(tell("simulation resume s").exit_code, 4);
  EXPECT_EQ(ask("simulation get s")["state"], "STOPPED");
  EXPECT_EQ(ask("simulation list")["simulations"].size(), 1u);
  EXPECT_GT(ask("simulation series s")["rows"].size(), 0u);
  EXPECT_THAT(tell("simulation series s").output, ::testing::StartsWith("step,time_s,"));
  ask("model delete " + model_name);
  EXPECT_EQ(tell("model get " + model_name).exit_code, 4);
  // The simulation outlives its model.
  ask("export s --out late");
  EXPECT_EQ(read_json("late/summary.json")["state"], "STOPPED");
  ask("simulation delete s");
  EXPECT_EQ(tell("simulation get s").exit_code, 4);
  EXPECT_EQ(tell("watch s").exit_code, 4);
  EXPECT_EQ(tell("operation get nothing").exit_code, 4);
}

TEST_F(CommandsTest, ChecksAPlanOnAModelAndMakesNothing) {
  ask("patient create --id p");
  const std::string model = ask("model build p plan.json")["name"];
  const auto check = ask("plan check plan.json --model " + model);
  EXPECT_EQ(check["zones"][0]["name"], "middle");
  EXPECT_EQ(check["violations"].size(), 0u);
  EXPECT_THAT(tell("plan check plan.json --model " + model).output, HasSubstr("The daemon takes this plan."));
  write_plan("thin.json", "/simulation/fat", nlohmann::json{{"density_kg_m3", -1}});
  const CommandResult refused = tell("plan check thin.json --model " + model);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("spec.fat.density_kg_m3 is -1 kg/m3"));
  EXPECT_EQ(tell("plan check plan.json --model patients/p/models/none").exit_code, 4);
  EXPECT_EQ(ask("simulation list")["simulations"].size(), 0u);
}

TEST_F(CommandsTest, FindsShapesAndGoesOnWithASettledSimulation) {
  ask("patient create --id p");
  const std::string model = ask("model build p plan.json")["name"];
  write_plan("settled.json", "/simulation/time", nlohmann::json{{"goal", "SETTLED_SHAPE"}});
  const auto shape = ask("shape settled.json --sensitivities --volume 1=0.25 --model " + model);
  EXPECT_NEAR(shape["summary"]["injected_ml"].get<double>(), 0.25, 1e-9);
  EXPECT_EQ(shape["from_rest"], true);
  EXPECT_EQ(shape["sensitivities"].size(), 3u) << "one pool, one layer by stiffness and by thickness";
  EXPECT_EQ(ask("simulation list")["simulations"].size(), 0u) << "nothing is kept";
  ask("simulation create settled.json --id s --start --model " + model);
  EXPECT_EQ(tell("watch s").exit_code, 0);
  const double lift = ask("simulation get s")["summary"]["skin_max_displacement_mm"];
  const double foreseen = ask("shape simulations/s --add middle=0.1")["summary"]["skin_max_displacement_mm"];
  EXPECT_GT(foreseen, lift);
  ask("simulation inject s --zone middle --volume-ml 0.1 --rate-ml-per-s 1");
  EXPECT_EQ(tell("watch s").exit_code, 0);
  const auto went_on = ask("simulation get s");
  EXPECT_EQ(went_on["state"], "SETTLED");
  EXPECT_NEAR(went_on["summary"]["skin_max_displacement_mm"].get<double>(), foreseen, 0.003);
  const CommandResult told = tell("shape simulations/s --add middle=0.1 --sensitivities");
  EXPECT_THAT(told.output, HasSubstr("not run and not kept"));
  EXPECT_THAT(told.output, HasSubstr("1 mL in middle"));

  EXPECT_EQ(tell("shape settled.json").exit_code, 2) << "no model";
  EXPECT_EQ(tell("shape simulations/s --add middle").exit_code, 2);
  EXPECT_EQ(tell("shape simulations/s --volume 0=1").exit_code, 2);
  EXPECT_THAT(tell("shape simulations/s --add nose=1").errors, HasSubstr("nose"));
  EXPECT_EQ(tell("shape simulations/none").exit_code, 4);
}

TEST_F(CommandsTest, KeepsAStateAndGoesBackToIt) {
  ask("patient create --id p");
  const std::string model = ask("model build p plan.json")["name"];
  write_plan("long.json", "/simulation/time/end_s", 100000.0);
  ask("simulation create long.json --id s --start --model " + model);
  for (int i = 0; i < 200 && ask("simulation get s")["summary"]["steps"] == "0"; ++i) continue;
  const auto kept = ask("simulation checkpoint s --id before --request-id r1");
  EXPECT_EQ(kept["name"], "simulations/s/checkpoints/before");
  EXPECT_EQ(ask("simulation checkpoint s --id before --request-id r1")["step"], kept["step"]);
  EXPECT_EQ(tell("simulation checkpoint s --id before").exit_code, 4);
  EXPECT_THAT(tell("simulation checkpoints s").output, HasSubstr("simulations/s/checkpoints/before  step "));
  ask("simulation inject s --zone middle --volume-ml 0.1 --rate-ml-per-s 1 --request-id i1");
  EXPECT_EQ(
      ask("simulation inject s --zone middle --volume-ml 0.1 --rate-ml-per-s 1 --request-id i1")["spec"]["injections"]
          .size(),
      2u);
  ask("simulation pause s");
  const auto back = ask("simulation restore simulations/s/checkpoints/before");
  EXPECT_EQ(back["state"], "PAUSED");
  EXPECT_EQ(back["summary"]["state_hash"], kept["state_hash"]);
  EXPECT_EQ(back["spec"]["injections"].size(), 1u);
  daemon_->kill_hard();
  start();
  EXPECT_EQ(ask("simulation get s")["summary"]["state_hash"], kept["state_hash"]);
  const auto other = ask("simulation restore simulations/s/checkpoints/before --new --id t --start");
  EXPECT_EQ(other["origin"], "simulations/s/checkpoints/before");
  EXPECT_EQ(other["state"], "RUNNING");
  EXPECT_EQ(tell("simulation restore simulations/s/checkpoints/before --id t").exit_code, 2);
  EXPECT_EQ(tell("simulation restore simulations/s/checkpoints/none").exit_code, 4);
  ask("simulation stop t");
  ask("simulation forget simulations/s/checkpoints/before");
  EXPECT_EQ(tell("simulation forget simulations/s/checkpoints/before").exit_code, 4);
}

TEST_F(CommandsTest, WatchGivesALineAFrame) {
  ask("patient create --id p");
  const std::string model = ask("model build p plan.json")["name"];
  ask("simulation create plan.json --id s --start --model " + model);
  const CommandResult watched = tell("watch s --every --interval-ms 100 --json");
  ASSERT_EQ(watched.exit_code, 0) << watched.errors;
  std::istringstream lines(watched.output);
  nlohmann::json frame;
  double last_time = -1.0;
  for (std::string line; std::getline(lines, line);) {
    frame = nlohmann::json::parse(line);
    EXPECT_GT(frame["time_s"].get<double>(), last_time);
    last_time = frame["time_s"];
  }
  EXPECT_EQ(frame["end"], true);
  EXPECT_EQ(frame["step"], 50);
  EXPECT_NEAR(frame["skin_max_displacement_mm"].get<double>(),
              ask("simulation get s")["summary"]["skin_max_displacement_mm"].get<double>(), 1e-4);
}

TEST_F(CommandsTest, ResultsOutliveTheDaemon) {
  const auto summary = ask("run plan.json --out out --no-picture --quiet");
  const std::string simulation = read_json("out/run.json")["simulation"];
  EXPECT_EQ(daemon_->terminate(), 0);
  EXPECT_EQ(tell("export " + simulation + " --out again").exit_code, 3);
  start();
  EXPECT_THAT(tell("export " + simulation + " --out again --deck tissue.inp").output,
              HasSubstr("at 0.5 s to tissue.inp"));
  EXPECT_THAT(read("tissue.inp"), ::testing::StartsWith("*HEADING\n"));
  EXPECT_EQ(read_json("again/summary.json")["state_hash"], summary["state_hash"]);
  EXPECT_EQ(read("again/series.csv"), read("out/series.csv"));
  EXPECT_EQ(read("again/skin_0000.vtp"), read("out/skin_0005.vtp"));
  ask("render " + simulation + " --out sheet.png");
  EXPECT_EQ(read("sheet.png").substr(1, 3), "PNG");
  write_plane("goal.obj", 0.5);
  const auto evaluation = ask("evaluate " + simulation + " --target goal.obj --out again");
  EXPECT_NEAR(evaluation["before_to_target"]["mean_mm"].get<double>(), 0.5, 1e-6);
}

TEST_F(CommandsTest, DiscardTakesEverythingAway) {
  ask("run plan.json --out out --discard --no-picture --quiet");
  EXPECT_EQ(ask("patient list")["patients"].size(), 0u);
  EXPECT_EQ(ask("simulation list")["simulations"].size(), 0u);
}

}  // namespace
}  // namespace lipofill::testing
