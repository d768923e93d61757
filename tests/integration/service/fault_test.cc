// What the daemon does when its data directory is full, read-only or damaged: it says so, and the
// rest goes on.

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;
using Simulations = v1::SimulationService::Stub;

class FaultTest : public RunTest {
 protected:
  FaultTest() : RunTest({"--checkpoint-interval-s", "0.02"}) {}

  fs::path data() const { return directory_.path() / "data"; }
  v1::Checkpoint checkpoint(const std::string& name, const std::string& id, grpc::Status* status = nullptr) {
    v1::CreateCheckpointRequest request;
    request.set_parent(name);
    request.set_checkpoint_id(id);
    v1::Checkpoint made;
    const grpc::Status done = call(*simulations_, &Simulations::CreateCheckpoint, request, made);
    EXPECT_TRUE(done.ok() || status != nullptr) << done.error_message();
    if (status != nullptr) *status = done;
    return made;
  }
  grpc::Status inject(const std::string& name) {
    v1::InjectRequest request;
    request.set_name(name);
    *request.mutable_injection() = parse_text<v1::Injection>("zone: 'middle' volume_ml: 0.02 rate_ml_per_s: 0.1");
    v1::Simulation simulation;
    return call(*simulations_, &Simulations::Inject, request, simulation);
  }
  bool has_checkpoint(const std::string& name) {
    v1::ListCheckpointsRequest request;
    request.set_parent(name);
    v1::ListCheckpointsResponse response;
    EXPECT_TRUE(call(*simulations_, &Simulations::ListCheckpoints, request, response).ok());
    return response.checkpoints_size() > 0;
  }
  void await_step(const std::string& name, uint64_t step) {
    while (get_simulation(name).summary().steps() < step && !HasFailure()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  std::string await_reason(const std::string& name, const std::string& part) {
    std::string reason;
    for (int i = 0; i < 5000 && reason.find(part) == std::string::npos; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      reason = get_simulation(name).reason();
    }
    return reason;
  }
  /// From here on no file of the daemon grows, as on a full disk; `false` takes that back.
  void fill_disk(bool full) {
    rlimit limit{};
    ASSERT_EQ(::prlimit(daemon_->pid(), RLIMIT_FSIZE, nullptr, &limit), 0);
    limit.rlim_cur = full ? 1 : limit.rlim_max;
    ASSERT_EQ(::prlimit(daemon_->pid(), RLIMIT_FSIZE, &limit, nullptr), 0);
  }
  static void flip_bit(const fs::path& path, size_t at) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(static_cast<std::streamoff>(at));
    const int byte = file.get();
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(byte ^ 16));
  }
};

TEST_F(FaultTest, AFullDiskIsToldAndRunsGoOn) {
  // At the pace of the clock, so that what waits for room stays within its bound on any machine.
  v1::SimulationSpec plan = square_plan(model_.name(), 100'000.0);
  plan.set_pace(v1::REAL_TIME);
  v1::Simulation created;
  ASSERT_TRUE(create_simulation(plan, "x", true, created).ok());
  while (get_simulation("simulations/x").summary().steps() < 1000 && !has_checkpoint("simulations/x")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  fill_disk(true);
  EXPECT_THAT(await_reason("simulations/x", "last checkpoint"), HasSubstr("the last checkpoint is of step "));
  const v1::Simulation running = get_simulation("simulations/x");
  EXPECT_EQ(running.state(), v1::Simulation::RUNNING);
  await_step("simulations/x", running.summary().steps() + 20);
  EXPECT_EQ(inject("simulations/x").error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(pause("simulations/x").error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  grpc::Status status;
  checkpoint("simulations/x", "mine", &status);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_EQ(get_simulation("simulations/x").spec().injections_size(), 1) << "what was refused was not done";
  EXPECT_TRUE(is_serving());

  fill_disk(false);
  EXPECT_TRUE(inject("simulations/x").ok());
  for (int i = 0; i < 5000 && !get_simulation("simulations/x").reason().empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_EQ(get_simulation("simulations/x").reason(), "");
  v1::Simulation stopped;
  ASSERT_TRUE(stop("simulations/x", &stopped).ok());
  for (uint64_t after = 0; after < stopped.summary().steps();) {
    const v1::GetSeriesResponse rows = series("simulations/x", after);
    ASSERT_GT(rows.rows_size(), 0) << "after step " << after;
    for (const v1::SeriesRow& row : rows.rows()) ASSERT_EQ(row.step(), ++after) << "rows waited for room";
  }
  restart_hard();
  EXPECT_EQ(get_simulation("simulations/x").summary().state_hash(), stopped.summary().state_hash());
}

TEST_F(FaultTest, AResultThatFoundNoRoomIsKeptLater) {
  create(1.0, "x", false);
  ASSERT_TRUE(start("simulations/x").ok());
  fill_disk(true);
  const v1::Simulation ended = await_end("simulations/x");
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED);
  EXPECT_THAT(get_simulation("simulations/x").reason(), HasSubstr("the result is not kept yet"));
  fill_disk(false);
  EXPECT_THAT(get_simulation("simulations/x").reason(), Not(HasSubstr("the result is not kept yet")));
  EXPECT_EQ(get_simulation("simulations/x").summary().state_hash(), ended.summary().state_hash());
  restart_hard();
  const v1::Simulation kept = get_simulation("simulations/x");
  EXPECT_EQ(kept.state(), v1::Simulation::FINISHED);
  EXPECT_EQ(kept.summary().state_hash(), ended.summary().state_hash());
  EXPECT_EQ(series("simulations/x").rows_size(), 100);
}

TEST_F(FaultTest, ADamagedCheckpointIsPassedOverAndTold) {
  constexpr double kEndS = 6.0;
  create(kEndS, "unbroken");
  const std::string hash = await_end("simulations/unbroken").summary().state_hash();
  // In real time, or it might end before a slow machine has looked at it.
  v1::SimulationSpec plan = square_plan(model_.name(), kEndS);
  plan.set_pace(v1::REAL_TIME);
  v1::Simulation paced;
  ASSERT_TRUE(create_simulation(plan, "x", true, paced).ok());
  await_step("simulations/x", 40);
  checkpoint("simulations/x", "older");
  await_step("simulations/x", 80);
  const v1::Checkpoint newer = checkpoint("simulations/x", "newer");
  daemon_->kill_hard();
  for (const auto& entry : fs::directory_iterator(data() / "checkpoints" / "x")) {
    const std::string id = entry.path().filename().string();
    if (id == "newer") flip_bit(entry.path(), fs::file_size(entry.path()) / 2);
    if (id != "newer" && id != "older") fs::resize_file(entry.path(), 100);
  }
  connect();
  EXPECT_THAT(await_reason("simulations/x", "checkpoints/newer"), HasSubstr("SHA-256"));
  v1::RestoreSimulationRequest request;
  request.set_checkpoint(newer.name());
  v1::Simulation none;
  EXPECT_EQ(call(*simulations_, &Simulations::RestoreSimulation, request, none).error_code(),
            grpc::StatusCode::DATA_LOSS);
  EXPECT_EQ(await_end("simulations/x").summary().state_hash(), hash);
  EXPECT_EQ(series("simulations/x").rows_size(), 600);
}

TEST_F(FaultTest, WithoutAnyCheckpointItBeginsAgain) {
  create(3.0, "unbroken");
  const std::string hash = await_end("simulations/unbroken").summary().state_hash();
  create(3.0, "x");
  await_step("simulations/x", 80);
  daemon_->kill_hard();
  fs::remove_all(data() / "checkpoints" / "x");
  connect();
  EXPECT_EQ(await_end("simulations/x").summary().state_hash(), hash);
  EXPECT_EQ(series("simulations/x").rows_size(), 300);
}

TEST_F(FaultTest, ABranchWithoutItsOriginWaitsForItAndTheRestGoesOn) {
  create(1000.0, "x");
  await_step("simulations/x", 20);
  v1::RestoreSimulationRequest request;
  request.set_checkpoint(checkpoint("simulations/x", "c").name());
  request.set_as_new(true);
  request.set_simulation_id("y");
  v1::Simulation branch;
  ASSERT_TRUE(call(*simulations_, &Simulations::RestoreSimulation, request, branch).ok());
  branch = get_simulation("simulations/y");
  daemon_->kill_hard();
  flip_bit(data() / "checkpoints" / "y" / "origin", 200);
  connect();
  v1::Simulation waiting = get_simulation("simulations/y");
  EXPECT_EQ(waiting.state(), v1::Simulation::READY);
  EXPECT_THAT(waiting.recovery().waiting_for(), HasSubstr("it began from simulations/x/checkpoints/c"));
  EXPECT_THAT(waiting.recovery().waiting_for(), HasSubstr("SHA-256"));
  EXPECT_EQ(get_simulation("simulations/x").state(), v1::Simulation::RUNNING);
  flip_bit(data() / "checkpoints" / "y" / "origin", 200);
  const auto is_back = [&] { return !waiting.has_recovery() && waiting.summary().steps() >= branch.summary().steps(); };
  for (int i = 0; i < 1000 && !is_back(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    waiting = get_simulation("simulations/y");
  }
  EXPECT_FALSE(waiting.has_recovery()) << "somebody put the right file in its place";
  EXPECT_EQ(waiting.summary().steps(), branch.summary().steps());
  EXPECT_EQ(waiting.summary().injected_ml(), branch.summary().injected_ml());
}

TEST_F(FaultTest, ADamagedDatabaseIsRefusedWithWhatToDo) {
  create(0.1, "x");
  await_end("simulations/x");
  EXPECT_EQ(daemon_->terminate(), 0);
  {
    std::fstream file(data() / "lipofill.sqlite", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(2 * 4096);
    file << std::string(4096, '\xa5');
  }
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--listen", "127.0.0.1:0", "--data", data().string()}, output), 1);
  EXPECT_THAT(output, HasSubstr("lipofill.sqlite is damaged"));
  EXPECT_THAT(output, HasSubstr("Put a backup in its place"));
}

TEST(ReadOnlyDirectory, IsRefusedByName) {
  TemporaryDirectory directory;
  const std::string data = directory.file("data");
  fs::create_directory(data);
  ::chmod(directory.path().c_str(), 0755);
  ::chmod(data.c_str(), 0555);
  const pid_t child = ::fork();
  if (child == 0) {
    // Root may write anywhere.
    if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(99);
    std::string text;
    ::_exit(run_daemon_to_end({"--listen", "127.0.0.1:0", "--data", data}, text) == 1 &&
                    text.find(data) != std::string::npos && text.find("Permission denied") != std::string::npos
                ? 0
                : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace lipofill::testing
