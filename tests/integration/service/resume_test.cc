// What was answered is there after the end of the daemon, however that came; checkpoints on
// command; going back.

#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;
using Simulations = v1::SimulationService::Stub;

class ResumeTest : public RunTest {
 protected:
  explicit ResumeTest(std::vector<std::string> arguments = {"--checkpoint-interval-s", "0.02"})
      : RunTest(std::move(arguments)) {}
  grpc::Status inject(const std::string& name, v1::Simulation& result, const std::string& request_id = "") {
    v1::InjectRequest request;
    request.set_name(name);
    request.set_request_id(request_id);
    *request.mutable_injection() = parse_text<v1::Injection>("zone: 'middle' volume_ml: 0.02 rate_ml_per_s: 0.1");
    return call(*simulations_, &Simulations::Inject, request, result);
  }
  v1::Checkpoint checkpoint(const std::string& name, const std::string& id = "", const std::string& request_id = "") {
    v1::CreateCheckpointRequest request;
    request.set_parent(name);
    request.set_checkpoint_id(id);
    request.set_request_id(request_id);
    v1::Checkpoint made;
    const grpc::Status status = call(*simulations_, &Simulations::CreateCheckpoint, request, made);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return made;
  }
  std::vector<v1::Checkpoint> checkpoints(const std::string& name) {
    v1::ListCheckpointsRequest request;
    request.set_parent(name);
    v1::ListCheckpointsResponse response;
    const grpc::Status status = call(*simulations_, &Simulations::ListCheckpoints, request, response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return {response.checkpoints().begin(), response.checkpoints().end()};
  }
  grpc::Status restore(const v1::RestoreSimulationRequest& request, v1::Simulation& result) {
    return call(*simulations_, &Simulations::RestoreSimulation, request, result);
  }
  void expect_whole_series(const std::string& name, uint64_t first, uint64_t last) {
    const v1::GetSeriesResponse all = series(name);
    ASSERT_EQ(static_cast<uint64_t>(all.rows_size()), last - first + 1);
    for (int i = 0; i < all.rows_size(); ++i) ASSERT_EQ(all.rows(i).step(), first + static_cast<uint64_t>(i));
  }
  void await_step(const std::string& name, uint64_t step) {
    while (get_simulation(name).summary().steps() < step && !HasFailure()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  std::filesystem::path files(const std::string& id) { return directory_.path() / "data" / "checkpoints" / id; }
  int count_files(const std::string& id) {
    std::error_code none;
    int n = 0;
    for (const auto& entry : std::filesystem::directory_iterator(files(id), none)) n += entry.is_regular_file();
    return n;
  }
};

TEST_F(ResumeTest, ARunGoesOnAfterAHardDeathToTheSameEnd) {
  create(3.0, "unbroken");
  const v1::Simulation unbroken = await_end("simulations/unbroken");
  create(3.0, "x");
  for (const uint64_t step : {60, 140, 220}) {
    await_step("simulations/x", step);
    restart_hard();
  }
  const v1::Simulation ended = await_end("simulations/x");
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED) << ended.reason();
  EXPECT_EQ(ended.summary().steps(), 300u);
  EXPECT_EQ(ended.summary().state_hash(), unbroken.summary().state_hash());
  expect_whole_series("simulations/x", 1, 300);
  const auto rows = series("simulations/x"), expected = series("simulations/unbroken");
  for (int i = 0; i < 300; ++i) {
    v1::SeriesRow row = rows.rows(i), other = expected.rows(i);
    for (v1::SeriesRow* timed : {&row, &other}) {
      timed->clear_wall_ms();
      timed->clear_cost();
    }
    EXPECT_EQ(row.SerializeAsString(), other.SerializeAsString()) << i;
  }
  EXPECT_EQ(count_files("x"), 0) << "its checkpoints are of no use any more";
}

TEST_F(ResumeTest, EveryStateAndCommandSurvivesAHardDeath) {
  create(1000.0, "ready", false);
  create(1000.0, "paused");
  create(1000.0, "running");
  create(1000.0, "stopped");
  create(1000.0, "deleted");
  v1::Simulation injected, paused, stopped;
  ASSERT_TRUE(inject("simulations/ready", injected).ok());
  ASSERT_TRUE(inject("simulations/running", injected, "i-1").ok());
  ASSERT_TRUE(pause("simulations/paused", &paused).ok());
  ASSERT_TRUE(inject("simulations/paused", injected).ok());
  ASSERT_TRUE(stop("simulations/stopped", &stopped, "s-1").ok());
  v1::DeleteSimulationRequest request;
  request.set_name("simulations/deleted");
  google::protobuf::Empty nothing;
  ASSERT_TRUE(call(*simulations_, &Simulations::DeleteSimulation, request, nothing).ok());
  restart_hard();

  EXPECT_EQ(get_simulation("simulations/ready").state(), v1::Simulation::READY);
  EXPECT_EQ(get_simulation("simulations/ready").spec().injections_size(), 2);
  EXPECT_EQ(get_simulation("simulations/running").state(), v1::Simulation::RUNNING);
  ASSERT_TRUE(inject("simulations/running", injected, "i-1").ok()) << "the same request again";
  EXPECT_EQ(injected.spec().injections_size(), 2) << "is not carried out again";
  await_step("simulations/paused", paused.summary().steps());
  const v1::Simulation still = get_simulation("simulations/paused");
  EXPECT_EQ(still.state(), v1::Simulation::PAUSED);
  EXPECT_EQ(still.summary().steps(), paused.summary().steps());
  EXPECT_EQ(still.spec().injections_size(), 2);
  EXPECT_EQ(get_simulation("simulations/stopped").SerializeAsString(), stopped.SerializeAsString());
  EXPECT_TRUE(stop("simulations/stopped", nullptr, "s-1").ok()) << "the same request again";
  EXPECT_EQ(stop("simulations/deleted").error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(count_files("deleted"), 0);
  for (const char* id : {"ready", "paused", "running"}) EXPECT_TRUE(stop(absl::StrCat("simulations/", id)).ok());
}

TEST_F(ResumeTest, APausedRunIsTheSameAfterAHardDeath) {
  create(1000.0, "x");
  await_step("simulations/x", 30);
  v1::Simulation paused;
  ASSERT_TRUE(pause("simulations/x", &paused).ok());
  restart_hard();
  await_step("simulations/x", paused.summary().steps());
  const v1::Simulation back = get_simulation("simulations/x");
  EXPECT_EQ(back.state(), v1::Simulation::PAUSED);
  EXPECT_EQ(back.summary().state_hash(), paused.summary().state_hash());
}

TEST_F(ResumeTest, SigtermLetsTheNextStartGoOn) {
  create(1000.0, "running");
  create(1000.0, "ready", false);
  Watcher watcher(*channel_, watch_request("simulations/running", v1::WatchRequest::EVERY));
  SeenFrame frame;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(watcher.next(frame));
  daemon_->signal(SIGTERM);
  SeenFrame last = frame;
  watcher.drain(&last);
  EXPECT_EQ(watcher.finish().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(daemon_->wait(), 0);
  connect();
  const v1::Simulation running = get_simulation("simulations/running");
  EXPECT_EQ(running.state(), v1::Simulation::RUNNING);
  EXPECT_GE(running.summary().steps(), last.slice.sequence()) << "nothing is computed again";
  EXPECT_EQ(get_simulation("simulations/ready").state(), v1::Simulation::READY);
  ASSERT_TRUE(stop("simulations/running").ok());
  expect_whole_series("simulations/running", 1, get_simulation("simulations/running").summary().steps());
}

TEST_F(ResumeTest, FramesComeInANewEpochAndViewersGoOn) {
  create(1000.0, "x");
  SeenFrame frame;
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::EVERY);
  {
    Watcher watcher(*channel_, request);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(watcher.next(frame));
  }
  const uint64_t epoch = frame.slice.epoch();
  restart_hard();
  request.set_seen_epoch(epoch);
  request.set_seen_sequence(frame.slice.sequence());
  Watcher again(*channel_, request);
  uint64_t sequence = 0;
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(again.next(frame));
    EXPECT_GT(frame.slice.epoch(), epoch);
    EXPECT_EQ(frame.slice.sequence(), i == 0 ? frame.slice.sequence() : sequence + 1);
    sequence = frame.slice.sequence();
  }
}

TEST_F(ResumeTest, AModelInUseIsHeld) {
  create(1000.0, "x");
  v1::DeleteModelRequest request;
  request.set_name(model_.name());
  google::protobuf::Empty nothing;
  const grpc::Status refused = call(*patients_, &v1::PatientService::Stub::DeleteModel, request, nothing);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(refused.error_message(), HasSubstr("simulations/x"));
  ASSERT_TRUE(stop("simulations/x").ok());
  EXPECT_TRUE(call(*patients_, &v1::PatientService::Stub::DeleteModel, request, nothing).ok());
}

TEST_F(ResumeTest, CheckpointsAreListedShownAndDeleted) {
  create(1000.0, "x", false);
  const v1::Checkpoint made = checkpoint("simulations/x", "mine", "r-1");
  EXPECT_EQ(made.name(), "simulations/x/checkpoints/mine");
  EXPECT_FALSE(made.automatic());
  EXPECT_TRUE(made.on_course());
  EXPECT_EQ(made.state_hash(), get_simulation("simulations/x").summary().state_hash());
  EXPECT_EQ(made.size_bytes(), std::filesystem::file_size(files("x") / "mine"));
  EXPECT_EQ(checkpoint("simulations/x", "mine", "r-1").SerializeAsString(), made.SerializeAsString());
  restart_hard();
  EXPECT_EQ(checkpoint("simulations/x", "mine", "r-1").SerializeAsString(), made.SerializeAsString());
  ASSERT_EQ(checkpoints("simulations/x").size(), 1u);

  v1::CreateCheckpointRequest create;
  create.set_parent("simulations/x");
  create.set_checkpoint_id("mine");
  v1::Checkpoint none;
  EXPECT_EQ(call(*simulations_, &Simulations::CreateCheckpoint, create, none).error_code(),
            grpc::StatusCode::ALREADY_EXISTS);
  create.set_parent("simulations/none");
  EXPECT_EQ(call(*simulations_, &Simulations::CreateCheckpoint, create, none).error_code(),
            grpc::StatusCode::NOT_FOUND);
  create.set_parent("patients/x");
  EXPECT_EQ(violations_of(call(*simulations_, &Simulations::CreateCheckpoint, create, none)).count("parent"), 1u);

  v1::GetCheckpointRequest get;
  get.set_name(made.name());
  v1::Checkpoint got;
  ASSERT_TRUE(call(*simulations_, &Simulations::GetCheckpoint, get, got).ok());
  EXPECT_EQ(got.SerializeAsString(), made.SerializeAsString());
  v1::DeleteCheckpointRequest remove;
  remove.set_name(made.name());
  google::protobuf::Empty nothing;
  ASSERT_TRUE(call(*simulations_, &Simulations::DeleteCheckpoint, remove, nothing).ok());
  EXPECT_EQ(call(*simulations_, &Simulations::GetCheckpoint, get, got).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(count_files("x"), 0);
  ASSERT_TRUE(stop("simulations/x").ok());
  create.set_parent("simulations/x");
  EXPECT_EQ(call(*simulations_, &Simulations::CreateCheckpoint, create, none).error_code(),
            grpc::StatusCode::FAILED_PRECONDITION);
}

TEST_F(ResumeTest, OnlyTheNewestFewAreKept) {
  create(1000.0, "x");
  await_step("simulations/x", 1500);
  EXPECT_LE(checkpoints("simulations/x").size(), 3u);
  EXPECT_GE(checkpoints("simulations/x").size(), 1u);
  ASSERT_TRUE(pause("simulations/x").ok());
  ASSERT_TRUE(get_simulation("simulations/x").has_summary());
  EXPECT_EQ(count_files("x"), static_cast<int>(checkpoints("simulations/x").size()));
  ASSERT_TRUE(stop("simulations/x").ok());
  EXPECT_TRUE(checkpoints("simulations/x").empty());
  EXPECT_EQ(count_files("x"), 0);
}

TEST_F(ResumeTest, GoesBackToACheckpointAndOnFromThere) {
  create(3.0, "unbroken");
  const std::string hash = await_end("simulations/unbroken").summary().state_hash();
  create(3.0, "x");
  await_step("simulations/x", 20);
  const v1::Checkpoint made = checkpoint("simulations/x", "c");
  v1::Simulation injected, back;
  ASSERT_TRUE(inject("simulations/x", injected).ok());
  const v1::Checkpoint later = checkpoint("simulations/x", "later");
  v1::RestoreSimulationRequest request;
  request.set_checkpoint(made.name());
  request.set_request_id("r-1");
  ASSERT_TRUE(pause("simulations/x").ok());
  const grpc::Status status = restore(request, back);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(back.state(), v1::Simulation::PAUSED);
  EXPECT_EQ(back.summary().steps(), made.step());
  EXPECT_EQ(back.summary().state_hash(), made.state_hash());
  EXPECT_EQ(back.spec().injections_size(), 1) << "the injection was after it";
  expect_whole_series("simulations/x", 1, made.step());

  restart_hard();
  EXPECT_EQ(get_simulation("simulations/x").summary().state_hash(), made.state_hash());
  ASSERT_TRUE(resume("simulations/x").ok());
  ASSERT_TRUE(restore(request, back).ok()) << "the same request again";
  request.set_checkpoint(later.name());
  request.set_request_id("");
  const grpc::Status left = restore(request, back);
  EXPECT_EQ(left.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  const v1::Simulation ended = await_end("simulations/x");
  EXPECT_EQ(ended.summary().state_hash(), hash);
  expect_whole_series("simulations/x", 1, 300);

  // What was left can still begin a new simulation.
  request.set_as_new(true);
  request.set_simulation_id("branch");
  request.set_request_id("r-2");
  v1::Simulation branch, again;
  ASSERT_TRUE(restore(request, branch).ok());
  EXPECT_EQ(branch.name(), "simulations/branch");
  EXPECT_EQ(branch.state(), v1::Simulation::READY);
  EXPECT_EQ(branch.origin(), later.name());
  EXPECT_EQ(branch.summary().steps(), later.step());
  EXPECT_EQ(branch.spec().injections_size(), 2);
  restart_hard();
  ASSERT_TRUE(restore(request, again).ok());
  EXPECT_EQ(again.name(), branch.name());
  ASSERT_TRUE(act<v1::StartSimulationRequest>(&Simulations::StartSimulation, branch.name()).ok());
  await_step(branch.name(), later.step() + 5);
  restart_hard();
  EXPECT_EQ(await_end(branch.name()).state(), v1::Simulation::FINISHED);
  expect_whole_series(branch.name(), later.step() + 1, 300);

  v1::Simulation none;
  request.set_simulation_id("branch");
  request.set_request_id("");
  EXPECT_EQ(restore(request, none).error_code(), grpc::StatusCode::ALREADY_EXISTS);
  request.set_as_new(false);
  EXPECT_EQ(violations_of(restore(request, none)).count("simulation_id"), 1u);
  request.set_simulation_id("");
  EXPECT_EQ(restore(request, none).error_code(), grpc::StatusCode::FAILED_PRECONDITION) << "it has ended";
}

TEST_F(ResumeTest, RestartedManyTimesAtOnceAllGoOn) {
  for (int i = 0; i < 6; ++i) create(2.0, absl::StrCat("x", i));
  for (int i = 0; i < 3; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    restart_hard();
  }
  const std::string hash = await_end("simulations/x0").summary().state_hash();
  for (int i = 1; i < 6; ++i) {
    EXPECT_EQ(await_end(absl::StrCat("simulations/x", i)).summary().state_hash(), hash);
  }
}

}  // namespace
}  // namespace lipofill::testing
