// A backup of a daemon under load, restored to another one.

#include <filesystem>
#include <thread>

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

namespace fs = std::filesystem;

class BackupTest : public RunTest {
 protected:
  BackupTest() : RunTest({"--checkpoint-interval-s", "0.05"}) {}
  int run(const std::vector<std::string>& arguments) { return run_daemon_to_end(arguments, output_); }

  std::string output_;
};

TEST_F(BackupTest, OneTakenUnderLoadGoesOnElsewhereToTheSameResult) {
  v1::Scan scan;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(), scan).ok());
  v1::SimulationSpec plan = square_plan(model_.name(), 1.0);
  plan.set_pace(v1::REAL_TIME);
  v1::Simulation simulation;
  ASSERT_TRUE(create_simulation(plan, "x", true, simulation).ok());
  while (get_simulation("simulations/x").summary().steps() < 20)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));

  const std::string data = directory_.file("data");
  const std::string backup = directory_.file("backup-b");
  for (const char* name : {"backup-a", "backup-b", "backup-c"}) {
    ASSERT_EQ(run({"--data", data, "--backup-to", directory_.file(name)}), 0) << output_;
  }
  EXPECT_EQ(std::system(("cd " + backup + " && sha256sum -c --quiet SHA256SUMS").c_str()), 0);
  const v1::Simulation ended = await_end("simulations/x");
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED);
  EXPECT_NE(run({"--data", data, "--restore-from", backup}), 0) << "a daemon uses it";

  EXPECT_EQ(daemon_->terminate(), 0);
  fs::rename(data, directory_.file("old"));
  ASSERT_EQ(run({"--data", data, "--restore-from", backup}), 0) << output_;
  EXPECT_NE(run({"--data", data, "--restore-from", backup}), 0) << "there is a store";
  connect();
  const v1::Simulation elsewhere = await_end("simulations/x");
  EXPECT_EQ(elsewhere.state(), v1::Simulation::FINISHED) << elsewhere.reason();
  EXPECT_EQ(elsewhere.summary().state_hash(), ended.summary().state_hash());
  v1::GetScanRequest get;
  get.set_name(scan.name());
  v1::Scan kept;
  ASSERT_TRUE(call(*patients_, &v1::PatientService::Stub::GetScan, get, kept).ok());
  EXPECT_TRUE(kept.complete());
}

}  // namespace
}  // namespace lipofill::testing
