// The daemon with its records in PostgreSQL: the same results to the byte, through the death of
// either.

#include <thread>

#include "tests/integration/service/run_fixture.h"
#include "tests/integration/service/sqlite_run.h"
#include "tests/unit/server/postgres_server.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class PostgresTest : public RunTest {
 protected:
  PostgresTest() : PostgresTest(PostgresServer::of_program().make_place()) {}
  explicit PostgresTest(const std::string& place)
      : RunTest({"--store", place, "--checkpoint-interval-s", "0.02"}), place_(place) {}
  void await_step(const std::string& name, uint64_t step) {
    while (get_simulation(name).summary().steps() < step && !HasFailure()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  /// Runs the daemon's program on the same store with one argument more, in place of serving.
  int run_task(const std::string& task, std::string& output, const std::string& value = "") {
    std::vector<std::string> arguments = {"--data", directory_.file("data"), "--store", place_, task};
    if (!value.empty()) arguments.push_back(value);
    return run_daemon_to_end(arguments, output);
  }

  const std::string place_;
};

TEST_F(PostgresTest, ARunThatWasKilledComesToTheBytesOfOneOnSqlite) {
  const v1::Simulation expected = SqliteRun().run(3.0);
  create(3.0, "x");
  for (const uint64_t step : {60, 140, 220}) {
    await_step("simulations/x", step);
    restart_hard();
  }
  const v1::Simulation ended = await_end("simulations/x");
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED) << ended.reason();
  EXPECT_EQ(ended.summary().steps(), expected.summary().steps());
  EXPECT_EQ(ended.summary().state_hash(), expected.summary().state_hash());
  const v1::GetSeriesResponse rows = series("simulations/x");
  ASSERT_EQ(rows.rows_size(), 300);
  for (int i = 0; i < rows.rows_size(); ++i) ASSERT_EQ(rows.rows(i).step(), static_cast<uint64_t>(i) + 1);
}

TEST_F(PostgresTest, LooksForDamageAndLeavesBackupsToPostgres) {
  create(0.1, "x");
  await_end("simulations/x");
  std::string output;
  EXPECT_EQ(run_task("--verify", output), 0) << output;
  EXPECT_THAT(output, HasSubstr("all is what was written"));
  PostgresServer::execute(place_,
                          "ALTER TABLE models DISABLE TRIGGER USER; UPDATE models SET spec = spec || '\\x00'::bytea; "
                          "ALTER TABLE models ENABLE TRIGGER USER");
  EXPECT_EQ(run_task("--verify", output), 3) << output;
  EXPECT_THAT(output, HasSubstr("patients/anna/models/"));
  EXPECT_EQ(run_task("--backup-to", output, directory_.file("backup")), 1);
  EXPECT_THAT(output, HasSubstr("pg_dump"));
  EXPECT_EQ(run_task("--restore-from", output, directory_.file("backup")), 1);
  EXPECT_THAT(output, HasSubstr("pg_restore"));
}

TEST_F(PostgresTest, ADirectoryOfAnotherStoreIsRefused) {
  std::string output;
  const std::string other = directory_.file("other");
  EXPECT_EQ(run_daemon_to_end({"--listen", "127.0.0.1:0", "--data", other, "--store", place_}, output), 1);
  EXPECT_THAT(output, HasSubstr("mount the directory that has its files"));
}

TEST_F(PostgresTest, APasswordInTheAddressIsRefusedAndNotRepeated) {
  for (const char* store : {"postgresql://anna:geheim@db.example/lipofill", "postgresql://db?password=geheim",
                            "mysql://anna:geheim@db.example/lipofill"}) {
    std::string output;
    EXPECT_EQ(run_daemon_to_end({"--data", directory_.file("other"), "--store", store}, output), 2);
    EXPECT_THAT(output, HasSubstr("store: "));
    EXPECT_THAT(output, Not(HasSubstr("geheim")));
  }
}

/// A server of its own, as it is to stop.
class PostgresRestartTest : public PostgresTest {
 protected:
  PostgresRestartTest() : PostgresRestartTest(std::make_unique<PostgresServer>()) {}
  explicit PostgresRestartTest(std::unique_ptr<PostgresServer> server)
      : PostgresTest(server->make_place()), server_(std::move(server)) {}
  ~PostgresRestartTest() override { daemon_->kill_hard(); }

  /// One who was just refused a connection asks for another one a moment later.
  void await_database() {
    v1::GetSimulationRequest request;
    request.set_name("simulations/x");
    v1::Simulation simulation;
    while (call(*simulations_, &v1::SimulationService::Stub::GetSimulation, request, simulation).error_code() ==
           grpc::StatusCode::UNAVAILABLE) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  std::unique_ptr<PostgresServer> server_;
};

TEST_F(PostgresRestartTest, ARunLivesThroughTheDeathOfTheDatabase) {
  const v1::Simulation expected = SqliteRun().run(3.0);
  create(3.0, "x");
  for (const uint64_t step : {60, 140}) {
    await_step("simulations/x", step);
    server_->crash();
    v1::Simulation simulation;
    v1::GetSimulationRequest request;
    request.set_name("simulations/x");
    const grpc::Status asked = call(*simulations_, &v1::SimulationService::Stub::GetSimulation, request, simulation);
    EXPECT_EQ(asked.error_code(), grpc::StatusCode::UNAVAILABLE) << asked.error_message();
    EXPECT_THAT(asked.error_message(), HasSubstr("no connection to postgresql://"));
    server_->start();
    await_database();
  }
  const v1::Simulation ended = await_end("simulations/x");
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED) << ended.reason();
  EXPECT_EQ(ended.summary().state_hash(), expected.summary().state_hash());
  EXPECT_EQ(series("simulations/x").rows_size(), 300);
}

TEST_F(PostgresRestartTest, CommandsAreCountedOnceThroughTheDeathOfTheDatabase) {
  create(1000.0, "x");
  constexpr int kInjections = 12;
  std::thread client([this] {
    for (int i = 0; i < kInjections; ++i) {
      v1::InjectRequest request;
      request.set_name("simulations/x");
      request.set_request_id("injection-" + std::to_string(i));
      *request.mutable_injection() = parse_text<v1::Injection>("zone: 'middle' volume_ml: 0.001 rate_ml_per_s: 0.1");
      v1::Simulation simulation;
      grpc::Status status;
      do {
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
        status = call(*simulations_, &v1::SimulationService::Stub::Inject, request, simulation);
      } while (status.error_code() == grpc::StatusCode::UNAVAILABLE);
      EXPECT_TRUE(status.ok()) << status.error_message();
    }
  });
  // The server ends with the thread that started it, which therefore is this one.
  for (int i = 0; i < 3; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    server_->crash();
    server_->start();
  }
  client.join();
  restart_hard();
  EXPECT_EQ(get_simulation("simulations/x").spec().injections_size(), 1 + kInjections);
  EXPECT_TRUE(stop("simulations/x").ok());
}

}  // namespace
}  // namespace lipofill::testing
