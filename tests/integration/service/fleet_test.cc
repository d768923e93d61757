// Several daemons on one database of PostgreSQL and one directory: who owns a simulation, what
// becomes of it when its daemon dies or freezes, and which daemons are refused.

#include "tests/integration/service/fleet_fixture.h"
#include "tests/integration/service/sqlite_run.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(FleetTest, ADaemonThatDiesIsSucceededToTheSameBytes) {
  const v1::Simulation expected = SqliteRun().run(20.0);
  const auto b = add("b");
  create(20.0, "x");
  await_step("simulations/x", 60);
  daemon_->kill_hard();
  const v1::Simulation ended = await_end_at(*b->simulations, "simulations/x");
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED) << ended.reason();
  EXPECT_EQ(ended.summary().state_hash(), expected.summary().state_hash());
  expect_every_step_once(series_at(*b->simulations, "simulations/x"), 2000);
  EXPECT_THAT(b->process.log(), HasSubstr("simulations/x has no daemon that lives: it goes on here; a was last heard"));
}

TEST_F(FleetTest, WhatADeadDaemonAcknowledgedIsThere) {
  const auto b = add("b");
  create(1000.0, "x");
  v1::InjectRequest inject;
  inject.set_name("simulations/x");
  *inject.mutable_injection() = parse_text<v1::Injection>("zone: 'middle' volume_ml: 0.02 rate_ml_per_s: 0.1");
  v1::Simulation simulation;
  for (int i = 0; i < 5; ++i) {
    inject.set_request_id("injection-" + std::to_string(i));
    ASSERT_TRUE(call(*simulations_, &v1::SimulationService::Stub::Inject, inject, simulation).ok());
  }
  daemon_->kill_hard();
  // The last one was answered, which its client may not have heard.
  ASSERT_TRUE(insist(*b->simulations, &v1::SimulationService::Stub::Inject, inject, simulation).ok());
  EXPECT_EQ(simulation.spec().injections_size(), 1 + 5);
  await_log(b->process, "s after the last sign of life of its daemon");
  v1::StopSimulationRequest stop;
  stop.set_name("simulations/x");
  ASSERT_TRUE(insist(*b->simulations, &v1::SimulationService::Stub::StopSimulation, stop, simulation).ok());
  expect_every_step_once(series_at(*b->simulations, "simulations/x"), simulation.summary().steps());
}

TEST_F(FleetTest, OneThatWasFrozenLetsGoOfWhatAnotherTook) {
  const auto b = add("b");
  create(1000.0, "x");
  await_step("simulations/x", 20);
  daemon_->signal(SIGSTOP);
  await_log(b->process, "simulations/x has no daemon that lives");
  const uint64_t steps = get(*b->simulations, "simulations/x").summary().steps();
  daemon_->signal(SIGCONT);
  await_log(*daemon_, "simulations/x is let go of");
  // It names the owner.
  v1::StopSimulationRequest stop;
  stop.set_name("simulations/x");
  v1::Simulation stopped;
  grpc::Status refused;
  do {  // as long as it has not learned who has it
    refused = call(*simulations_, &v1::SimulationService::Stub::StopSimulation, stop, stopped);
    ASSERT_EQ(refused.error_code(), grpc::StatusCode::UNAVAILABLE) << refused.error_message();
    ASSERT_THAT(refused.error_message(), Not(HasSubstr("draining")));
  } while (refused.error_message().find("has no lease") != std::string::npos);
  EXPECT_THAT(refused.error_message(),
              HasSubstr("simulations/x belongs to the daemon b at " + b->process.address() + "; ask there"));
  await_step_at(*b->simulations, "simulations/x", steps + 1);
  ASSERT_TRUE(insist(*b->simulations, &v1::SimulationService::Stub::StopSimulation, stop, stopped).ok());
  EXPECT_EQ(stopped.state(), v1::Simulation::STOPPED);
  expect_every_step_once(series_at(*b->simulations, "simulations/x"), stopped.summary().steps());
  EXPECT_EQ(get(*b->simulations, "simulations/x").SerializeAsString(), stopped.SerializeAsString());
  EXPECT_EQ(daemon_->terminate(), 0);
}

TEST_F(FleetTest, OneThatDrainsHandsOver) {
  const v1::Simulation expected = SqliteRun().run(20.0);
  const auto b = add("b");
  create(20.0, "x");
  await_step("simulations/x", 60);
  EXPECT_EQ(daemon_->terminate(), 0);
  const v1::Simulation ended = await_end_at(*b->simulations, "simulations/x");
  EXPECT_EQ(ended.summary().state_hash(), expected.summary().state_hash());
  expect_every_step_once(series_at(*b->simulations, "simulations/x"), 2000);
}

TEST_F(FleetTest, TwoSurvivorsShareWhatADeadOneHad) {
  const auto b = add("b"), c = add("c");
  const std::string hash = SqliteRun().run(3.0).summary().state_hash();
  for (const char* id : {"s", "t", "u", "v"}) create(3.0, id);
  await_step("simulations/v", 10);
  daemon_->kill_hard();
  for (const char* id : {"s", "t", "u", "v"}) {
    const std::string name = std::string("simulations/") + id;
    EXPECT_EQ(await_end_at(*b->simulations, name).summary().state_hash(), hash) << id;
    EXPECT_EQ(await_end_at(*c->simulations, name).summary().state_hash(), hash) << id;
    expect_every_step_once(series_at(*c->simulations, name), 300);
  }
}

TEST_F(FleetTest, ANameIsOfOneDaemon) {
  std::string output;
  std::vector<std::string> arguments = arguments_of(place_, "a");
  arguments.insert(arguments.end(), {"--listen", "127.0.0.1:0", "--data", data_of("b")});
  EXPECT_EQ(run_daemon_to_end(arguments, output), 1);
  EXPECT_THAT(output, HasSubstr("is in use by another lipofilld of the name a: give this one a name of its own"));
  arguments = arguments_of(place_, "a/b");
  EXPECT_EQ(run_daemon_to_end(arguments, output), 2);
  EXPECT_THAT(output, HasSubstr("name: is \"a/b\", must be 1 to 64 letters"));
}

TEST_F(FleetTest, ACopyOfTheDirectoryIsRefused) {
  create(0.1, "x");
  await_end("simulations/x");
  const std::string copy = directory_.file("copy");
  std::filesystem::copy(directory_.file("data"), copy, std::filesystem::copy_options::recursive);
  const std::filesystem::path beat = directory_.path() / "data" / "daemons" / "a";
  const auto changed = [&beat, at = std::filesystem::last_write_time(beat)] {
    return std::filesystem::last_write_time(beat) > at + std::chrono::seconds(5);
  };
  while (!changed()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::string output;
  std::vector<std::string> arguments = arguments_of(place_, "b");
  arguments.insert(arguments.end(), {"--listen", "127.0.0.1:0", "--data", copy});
  EXPECT_EQ(run_daemon_to_end(arguments, output), 1);
  EXPECT_THAT(output, HasSubstr("has its files in another directory than"));
  EXPECT_EQ(get_simulation("simulations/x").state(), v1::Simulation::FINISHED);
}

TEST_F(FleetTest, OneThatLostTheDirectoryIsSucceeded) {
  const auto b = add("b");
  create(1000.0, "x");
  await_step("simulations/x", 20);
  std::filesystem::remove(directory_.path() / "data" / "daemons" / "a");
  await_log(*daemon_, "the directory that this daemon shares has gone");
  await_log(b->process, "simulations/x has no daemon that lives");
  await_log(*daemon_, "simulations/x is let go of");
  const uint64_t steps = get(*b->simulations, "simulations/x").summary().steps();
  await_step_at(*b->simulations, "simulations/x", steps + 1);
}

TEST_F(FleetTest, OwnersWrittenByHandAreFoundOut) {
  create(1000.0, "x");
  create(1000.0, "y");
  await_step("simulations/y", 20);
  PostgresServer::execute(place_,
                          "UPDATE simulation_owners SET daemon = 123456 WHERE simulation = 'x'; "
                          "DELETE FROM simulation_owners WHERE simulation = 'y'; "
                          "UPDATE daemons SET renewed = now() + interval '1 day'");
  for (const char* id : {"x", "y"}) {
    const std::string name = std::string("simulations/") + id;
    await_log(*daemon_, name + " is let go of");
    await_log(*daemon_, name + " has no daemon that lives: it goes on here");
    const uint64_t steps = get(*simulations_, name).summary().steps();
    await_step_at(*simulations_, name, steps + 1);
    v1::StopSimulationRequest stop;
    stop.set_name(name);
    v1::Simulation stopped;
    ASSERT_TRUE(insist(*simulations_, &v1::SimulationService::Stub::StopSimulation, stop, stopped).ok());
    expect_every_step_once(series_at(*simulations_, name), stopped.summary().steps());
  }
}

TEST_F(FleetTest, ADaemonWhoseRowIsTakenOutComesBack) {
  const auto b = add("b");
  create(1000.0, "x");
  await_step("simulations/x", 20);
  PostgresServer::execute(place_, "DELETE FROM daemons WHERE name = 'a'");
  // Either of them has it by then, and knows its newest step.
  const auto newest_step = [&] {
    return std::max(get(*simulations_, "simulations/x").summary().steps(),
                    get(*b->simulations, "simulations/x").summary().steps());
  };
  const uint64_t steps = newest_step();
  while (newest_step() <= steps && !HasFailure()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  v1::StopSimulationRequest stop;
  stop.set_name("simulations/x");
  v1::Simulation stopped;
  grpc::Status status;
  do {
    status = call(*b->simulations, &v1::SimulationService::Stub::StopSimulation, stop, stopped);
    if (status.ok()) break;
    status = call(*simulations_, &v1::SimulationService::Stub::StopSimulation, stop, stopped);
  } while (status.error_code() == grpc::StatusCode::UNAVAILABLE);
  ASSERT_TRUE(status.ok()) << status.error_message();
  expect_every_step_once(series_at(*b->simulations, "simulations/x"), stopped.summary().steps());
}

}  // namespace
}  // namespace lipofill::testing
