// A store whose server stops, dies and comes back, and whose connection is lost at the worst
// moment; and two daemons on one database.

#include "server/store/postgres_database.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "absl/strings/str_cat.h"
#include "server/store/sql_store.h"
#include "tests/unit/server/store/breaking_proxy.h"
#include "tests/unit/server/store/store_kinds.h"

namespace lipofill::server {
namespace {

using lipofill::testing::BreakingProxy;
using lipofill::testing::PostgresServer;
using ::testing::HasSubstr;

std::unique_ptr<SqlStore> open(const std::string& place) {
  auto store = SqlStore::open(place);
  EXPECT_TRUE(store.ok()) << store.status();
  return store.ok() ? *std::move(store) : nullptr;
}

void add_simulation(SqlStore& store) {
  SimulationRecord simulation;
  simulation.id = "x";
  simulation.model = "patients/anna/models/m";
  ASSERT_TRUE(store.create_simulation(simulation, {}).ok());
}

CommandRecord injection() {
  return {"x", 0, CommandKind::kInject, 1, "fat", 1};
}

class PostgresDatabaseTest : public ::testing::Test {
 protected:
  lipofill::testing::TemporaryDirectory directory_;
  const std::string place_ = make_place(StoreKind::kPostgres, directory_);
};

TEST_F(PostgresDatabaseTest, AServerThatIsStartedAgainIsReachedAgain) {
  PostgresServer server;
  const auto store = open(server.make_place());
  ASSERT_TRUE(store->create_patient({"anna", "", {}, 1}, {}).ok());
  for (const bool crashes : {false, true}) {
    crashes ? server.crash() : server.stop();
    const auto refused = store->create_patient({"berta", "", {}, 1}, {});
    EXPECT_TRUE(absl::IsUnavailable(refused.status())) << refused.status();
    EXPECT_THAT(std::string(refused.status().message()), HasSubstr("no connection to postgresql://"));
    EXPECT_TRUE(absl::IsUnavailable(store->get_patient("anna").status()));
    server.start();
    // One who was just refused a connection asks for another one a moment later.
    while (absl::IsUnavailable(store->get_patient("anna").status())) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(store->get_patient("anna").ok()) << store->get_patient("anna").status();
    EXPECT_TRUE(absl::IsNotFound(store->get_patient("berta").status())) << "what was refused was not done";
  }
  EXPECT_TRUE(store->create_patient({"berta", "", {}, 1}, {}).ok());
}

TEST_F(PostgresDatabaseTest, ACallWaitsForAServerThatIsOnItsWay) {
  PostgresServer server;
  const auto store = open(server.make_place());
  server.crash();
  absl::Status made = absl::UnknownError("");
  std::thread caller([&] { made = store->create_patient({"anna", "", {}, 1}, {}).status(); });
  server.start();
  caller.join();
  EXPECT_TRUE(made.ok()) << made;
}

TEST_F(PostgresDatabaseTest, AConnectionLostBeforeCommitLeavesNothingAndIsMadeGood) {
  const auto store = open(place_);
  ASSERT_TRUE(store->create_patient({"anna", "old", {}, 1}, {}).ok());
  int calls = 0;
  const auto changed = store->update_patient("anna", [&](PatientRecord present) -> absl::StatusOr<PatientRecord> {
    if (++calls == 1) {
      PostgresServer::execute(place_,
                              "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE application_name = "
                              "'lipofilld' AND state = 'idle in transaction'");
    }
    present.display_name = absl::StrCat(present.display_name, "+");
    return present;
  });
  ASSERT_TRUE(changed.ok()) << changed.status();
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(store->get_patient("anna")->display_name, "old+");
}

TEST_F(PostgresDatabaseTest, ACommitWhoseAnswerWasLostIsNotDoneTwice) {
  BreakingProxy proxy(directory_.path().string(), PostgresServer::of_program().directory());
  const auto store = open(PostgresServer::through(place_, directory_.path().string()));
  add_simulation(*store);
  for (size_t n = 1; n <= 6; ++n) {
    n % 2 == 1 ? proxy.lose_next_answer_to_commit() : proxy.lose_next_commit();
    const auto kept = store->append_command(injection(), "", {});
    ASSERT_TRUE(kept.ok()) << kept.status();
    EXPECT_TRUE(*kept);
    EXPECT_TRUE(proxy.has_lost());
    ASSERT_EQ(store->list_commands("x")->size(), n) << "neither lost nor doubled";
  }
}

TEST_F(PostgresDatabaseTest, DaemonsThatMeetNumberTheirCommandsInOneOrder) {
  constexpr int kStores = 4, kCommands = 30;
  add_simulation(*open(place_));
  std::vector<std::thread> threads;
  for (int t = 0; t < kStores; ++t) {
    threads.emplace_back([this] {
      const auto store = open(place_);
      for (int i = 0; i < kCommands; ++i) {
        const auto kept = store->append_command(injection(), "", {});
        EXPECT_TRUE(kept.ok()) << kept.status();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const auto commands = open(place_)->list_commands("x");
  ASSERT_EQ(commands->size(), static_cast<size_t>(kStores * kCommands));
  for (size_t i = 0; i < commands->size(); ++i) EXPECT_EQ((*commands)[i].number, i + 1);
}

TEST_F(PostgresDatabaseTest, ARequestThatTwoDaemonsTakeIsCarriedOutOnce) {
  constexpr int kRequests = 30;
  const auto create = [this](const std::string& daemon) {
    const auto store = open(place_);
    for (int i = 0; i < kRequests; ++i) {
      const RequestKey key{"CreatePatient", absl::StrCat("r", i), "f"};
      const auto made = store->create_patient({absl::StrCat(daemon, i), "", {}, 1}, key);
      EXPECT_TRUE(made.ok()) << made.status();
    }
  };
  std::thread other(create, "b");
  create("a");
  other.join();
  EXPECT_EQ(open(place_)->list_patients({}, {"", 1000})->size(), static_cast<size_t>(kRequests));
}

TEST_F(PostgresDatabaseTest, TheOwnerThatAnotherDaemonReplacedIsNotRemembered) {
  const auto ours = open(place_), theirs = open(place_);
  SimulationRecord simulation;
  simulation.id = "x";
  simulation.model = "patients/anna/models/m";
  simulation.tenant = "ward";
  ASSERT_TRUE(ours->create_simulation(simulation, {}).ok());
  EXPECT_EQ(ours->owner_of_simulation("x")->tenant, "ward");
  ASSERT_TRUE(theirs->delete_simulation("x").ok());
  simulation.tenant = "clinic";
  ASSERT_TRUE(theirs->create_simulation(simulation, {}).ok());
  EXPECT_EQ(ours->owner_of_simulation("x")->tenant, "clinic");
}

TEST_F(PostgresDatabaseTest, SaysThatThereIsNoServer) {
  const absl::Status refused = SqlStore::open("postgresql://u@/d?host=/nowhere").status();
  EXPECT_TRUE(absl::IsUnavailable(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("no connection to postgresql:///nowhere:5432/d"));
}

}  // namespace
}  // namespace lipofill::server
