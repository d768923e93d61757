// Simulations that nobody asks for are kept on disk alone, and come back when somebody does, as if
// they had never left.

#include <random>
#include <thread>

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using Simulations = v1::SimulationService::Stub;

class ParkingTest : public RunTest {
 protected:
  explicit ParkingTest(const std::string& after_s = "0.2") : RunTest({"--park-after-s", after_s}) {}

  v1::Simulation await_parked(const std::string& name) {
    v1::Simulation simulation = get_simulation(name);
    for (int i = 0; i < 1000 && !simulation.parked(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      simulation = get_simulation(name);
    }
    EXPECT_TRUE(simulation.parked()) << name;
    return simulation;
  }
  /// Paused at some step of a run of `end_s`, which is so far away that it does not end before,
  /// however late the pause comes.
  v1::Simulation pause_on_the_way(const std::string& id, double end_s = 1e5) {
    v1::SimulationSpec plan = square_plan(model_.name(), end_s);
    plan.set_pace(v1::REAL_TIME);
    v1::Simulation simulation;
    EXPECT_TRUE(create_simulation(plan, id, true, simulation).ok());
    const std::string name = simulation.name();
    while (get_simulation(name).summary().steps() < 3) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_TRUE(pause(name, &simulation).ok());
    return simulation;
  }
};

TEST_F(ParkingTest, OneThatIsResumedEndsAsIfItHadStayed) {
  v1::Simulation straight;
  ASSERT_TRUE(create_simulation(square_plan(model_.name(), 3.0), "straight", true, straight).ok());
  const v1::Simulation paused = pause_on_the_way("x", 3.0);
  const v1::Simulation parked = await_parked("simulations/x");
  EXPECT_EQ(parked.state(), v1::Simulation::PAUSED);
  EXPECT_EQ(parked.summary().steps(), paused.summary().steps());
  EXPECT_EQ(parked.summary().state_hash(), paused.summary().state_hash());
  EXPECT_EQ(series("simulations/x").rows_size(), static_cast<int>(paused.summary().steps()));
  v1::Simulation resumed;
  ASSERT_TRUE(resume("simulations/x", &resumed).ok());
  EXPECT_FALSE(resumed.parked());
  const v1::Simulation ended = await_end("simulations/x");
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED);
  EXPECT_EQ(ended.summary().state_hash(), await_end("simulations/straight").summary().state_hash());
  EXPECT_EQ(series("simulations/x").rows_size(), static_cast<int>(ended.summary().steps()));
}

TEST_F(ParkingTest, StaysParkedWhenTheDaemonIsKilledAndComesBackWhenAsked) {
  const v1::Simulation paused = pause_on_the_way("x");
  create(0.3, "y", false);
  await_parked("simulations/x");
  await_parked("simulations/y");
  restart_hard();
  EXPECT_EQ(get_simulation("simulations/x").summary().state_hash(), paused.summary().state_hash());
  EXPECT_TRUE(get_simulation("simulations/x").parked());
  ASSERT_TRUE(start("simulations/y").ok());
  EXPECT_EQ(await_end("simulations/y").state(), v1::Simulation::FINISHED);
}

TEST_F(ParkingTest, EveryCallThatNeedsItBringsItBack) {
  const v1::Simulation paused = pause_on_the_way("x");
  const std::string name = "simulations/x";

  await_parked(name);
  Watcher watcher(*channel_, watch_request(name, v1::WatchRequest::LATEST));
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_EQ(frame.slice.sequence(), paused.summary().steps());
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_FALSE(get_simulation(name).parked()) << "it is watched";
  watcher.cancel();

  await_parked(name);
  const auto inject = parse_text<v1::InjectRequest>(
      "name: 'simulations/x' injection { zone: 'middle' volume_ml: 0.01 rate_ml_per_s: 0.1 }");
  v1::Simulation simulation;
  ASSERT_TRUE(call(*simulations_, &Simulations::Inject, inject, simulation).ok());
  EXPECT_EQ(simulation.spec().injections_size(), paused.spec().injections_size() + 1);

  await_parked(name);
  v1::CreateCheckpointRequest checkpoint;
  checkpoint.set_parent(name);
  v1::Checkpoint kept;
  ASSERT_TRUE(call(*simulations_, &Simulations::CreateCheckpoint, checkpoint, kept).ok());
  EXPECT_EQ(kept.step(), paused.summary().steps());

  await_parked(name);
  v1::RestoreSimulationRequest restore;
  restore.set_checkpoint(kept.name());
  ASSERT_TRUE(call(*simulations_, &Simulations::RestoreSimulation, restore, simulation).ok());

  await_parked(name);
  ASSERT_TRUE(stop(name, &simulation).ok());
  EXPECT_EQ(simulation.state(), v1::Simulation::STOPPED);
  EXPECT_EQ(simulation.summary().steps(), paused.summary().steps());
}

TEST_F(ParkingTest, OneThatIsParkedCanBeDeleted) {
  create(0.3, "x", false);
  await_parked("simulations/x");
  v1::DeleteSimulationRequest remove;
  remove.set_name("simulations/x");
  google::protobuf::Empty nothing;
  ASSERT_TRUE(call(*simulations_, &Simulations::DeleteSimulation, remove, nothing).ok());
  EXPECT_EQ(start("simulations/x").error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(ParkingTest, ManyWhoAskAtOnceGetTheSameOne) {
  const v1::Simulation paused = pause_on_the_way("x");
  await_parked("simulations/x");
  std::vector<std::jthread> callers;
  std::atomic<int> answered = 0;
  for (int i = 0; i < 8; ++i) {
    callers.emplace_back([&] {
      v1::CreateCheckpointRequest checkpoint;
      checkpoint.set_parent("simulations/x");
      v1::Checkpoint kept;
      if (!call(*simulations_, &Simulations::CreateCheckpoint, checkpoint, kept).ok()) return;
      answered += kept.state_hash() == paused.summary().state_hash() ? 1 : 0;
    });
  }
  callers.clear();
  EXPECT_EQ(answered, 8);
}

/// Parks whatever nobody asks for at this very moment.
class HastyParkingTest : public ParkingTest {
 protected:
  HastyParkingTest() : ParkingTest("0.001") {}
};

TEST_F(HastyParkingTest, NobodyIsTurnedAwayBecauseItIsBeingParked) {
  v1::Simulation simulation;
  for (const char* id : {"a", "b", "c", "d"}) {
    ASSERT_TRUE(create_simulation(square_plan(model_.name(), 1e5), id, true, simulation).ok()) << "READY for a moment";
    EXPECT_EQ(simulation.state(), v1::Simulation::RUNNING);
    ASSERT_TRUE(stop(simulation.name()).ok());
  }
  create(1e5, "x", false);
  const auto inject = parse_text<v1::InjectRequest>(
      "name: 'simulations/x' validate_only: true injection { zone: 'middle' volume_ml: 0.01 rate_ml_per_s: 0.1 }");
  const auto watch = watch_request("simulations/x", v1::WatchRequest::LATEST);
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60));
    const grpc::Status foreseen = call(*simulations_, &Simulations::Inject, inject, simulation);
    EXPECT_TRUE(foreseen.ok()) << i << ": " << foreseen.error_message();
    if (i % 3 > 0) continue;
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60));
    Watcher watcher(*channel_, watch);
    SeenFrame frame;
    EXPECT_TRUE(watcher.next(frame)) << i;
    watcher.cancel();
  }
}

}  // namespace
}  // namespace lipofill::testing
