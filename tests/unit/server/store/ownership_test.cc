#include "server/store/ownership.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "server/store/sql_store.h"
#include "tests/unit/server/postgres_server.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using lipofill::testing::PostgresServer;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A daemon, as far as its share of a store goes.
struct Daemon {
  Daemon(const std::string& data, const std::string& place, const std::string& name)
      : directory(*DataDirectory::open_shared(data, name)),
        store(*SqlStore::open(place)),
        ownership(*Ownership::open(place)) {
    const auto others = ownership->join(directory, "1.0");
    EXPECT_TRUE(others.ok()) << others.status();
    store->fence_by(*ownership);
  }
  /// Makes the lease outlast the test, however long that takes.
  void keep_lease(const std::string& place) const {
    PostgresServer::execute(
        place, "UPDATE daemons SET renewed = now() + interval '3 seconds' WHERE name = '" + ownership->name() + "'");
    ownership->tenures()->extend(LeaseClock::now() + std::chrono::hours(1));
  }
  void end_lease(const std::string& place) const {
    PostgresServer::execute(
        place, "UPDATE daemons SET renewed = now() - interval '5 seconds' WHERE name = '" + ownership->name() + "'");
  }

  DataDirectory directory;
  std::unique_ptr<SqlStore> store;
  std::unique_ptr<Ownership> ownership;
};

class OwnershipTest : public ::testing::Test {
 protected:
  void SetUp() override {
    a_.keep_lease(place_);
    b_.keep_lease(place_);
  }
  static SimulationRecord simulation(const std::string& id) {
    SimulationRecord record;
    record.id = id;
    record.model = "patients/anna/models/m";
    return record;
  }
  static absl::Status write(Daemon& daemon, const std::string& id = "x") {
    return daemon.store->append_command({id, 0, CommandKind::kStart, 0, "", 1}, "", {}).status();
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::string data_ = directory_.file("data");
  const std::string place_ = PostgresServer::of_program().make_place();
  Daemon a_{data_, place_, "a"};
  Daemon b_{data_, place_, "b"};
};

TEST_F(OwnershipTest, WhoMakesASimulationOwnsIt) {
  ASSERT_TRUE(b_.ownership->announce("db:50061").ok());
  ASSERT_TRUE(b_.store->create_simulation(simulation("x"), {}).ok());
  const auto owner = a_.ownership->owner_of("x");
  ASSERT_TRUE(owner.ok() && owner->has_value());
  EXPECT_EQ((*owner)->name, "b");
  EXPECT_TRUE((*owner)->is_live);
  EXPECT_TRUE(write(b_).ok());
  for (const absl::Status& refused :
       {write(a_), a_.ownership->take("x"), a_.store->delete_simulation("x"), a_.store->keep_summary("x", "s"),
        a_.store->begin_epoch("x", 1).status(), a_.store->set_simulation_state("x", SimulationState::kFailed, "r"),
        a_.store->append_series("x", {1, 1, "r"}), a_.store->cut_series("x", 0), a_.store->prune_checkpoints("x", 1),
        a_.store->end_simulation(simulation("x"), {"m", "f"})}) {
    EXPECT_TRUE(absl::IsUnavailable(refused)) << refused;
    EXPECT_TRUE(is_owned_elsewhere(refused));
    EXPECT_THAT(std::string(refused.message()), HasSubstr("simulations/x belongs to the daemon b at db:50061"));
  }
  EXPECT_EQ(a_.store->list_commands("x")->size(), 1u);
}

TEST_F(OwnershipTest, ALeaseThatEndedIsTakenAndItsOldOwnerIsRefused) {
  ASSERT_TRUE(a_.store->create_simulation(simulation("x"), {}).ok());
  EXPECT_THAT(*b_.ownership->list_orphans(), IsEmpty());
  a_.end_lease(place_);
  EXPECT_THAT(*b_.ownership->list_orphans(), ElementsAre(Field(&Orphan::simulation, "x")));
  EXPECT_TRUE(write(a_).ok()) << "nobody has taken it";
  ASSERT_TRUE(b_.ownership->take("x").ok());
  EXPECT_EQ(b_.ownership->n_takeovers(), 1u);
  EXPECT_TRUE(is_owned_elsewhere(write(a_)));
  ASSERT_TRUE(a_.ownership->renew().ok());
  b_.keep_lease(place_);
  EXPECT_TRUE(is_owned_elsewhere(a_.ownership->take("x")));
  EXPECT_TRUE(write(b_).ok());
  EXPECT_THAT(*a_.ownership->list_own(), IsEmpty());
  EXPECT_EQ(b_.ownership->list_own()->at("x"), *b_.ownership->tenures()->epoch_of("x"));
}

// Taken, lost and taken again: what began in the earlier epoch is not written in the later one.
TEST_F(OwnershipTest, NoEpochComesAgain) {
  ASSERT_TRUE(a_.store->create_simulation(simulation("x"), {}).ok());
  const uint64_t first = *a_.ownership->tenures()->epoch_of("x");
  ASSERT_TRUE(a_.ownership->take("x").ok());
  const uint64_t second = *a_.ownership->tenures()->epoch_of("x");
  EXPECT_GT(second, first);
  a_.ownership->give_back("x", first);
  EXPECT_TRUE(write(a_).ok());
  a_.ownership->give_back("x", second);
  EXPECT_TRUE(is_owned_elsewhere(write(a_)));
  ASSERT_TRUE(b_.ownership->take("x").ok());
  EXPECT_EQ(b_.ownership->n_takeovers(), 0u) << "nobody had it";
}

// Takers wait for what is being written, and writers who come later find the new owner.
TEST_F(OwnershipTest, EveryCommandIsKeptBeforeItsSuccessorLooks) {
  ASSERT_TRUE(a_.store->create_simulation(simulation("x"), {}).ok());
  size_t n_kept = 0;
  std::thread writer([this, &n_kept] {
    while (write(a_).ok()) ++n_kept;
  });
  while (b_.store->list_commands("x")->size() < 20) std::this_thread::yield();
  a_.end_lease(place_);
  ASSERT_TRUE(b_.ownership->take("x").ok());
  const size_t n_found = b_.store->list_commands("x")->size();
  writer.join();
  EXPECT_EQ(n_found, n_kept);
  EXPECT_EQ(b_.store->list_commands("x")->size(), n_kept);
}

TEST_F(OwnershipTest, WhatHasEndedIsNobodys) {
  ASSERT_TRUE(a_.store->create_simulation(simulation("x"), {}).ok());
  SimulationRecord ended = simulation("x");
  ended.state = SimulationState::kFinished;
  ASSERT_TRUE(a_.store->end_simulation(ended, {"m", "f"}).ok());
  EXPECT_FALSE(a_.ownership->owner_of("x")->has_value());
  EXPECT_FALSE(a_.ownership->tenures()->epoch_of("x").has_value());
  a_.end_lease(place_);
  EXPECT_THAT(*b_.ownership->list_orphans(), IsEmpty());
  EXPECT_TRUE(b_.store->delete_simulation("x").ok());
}

TEST_F(OwnershipTest, LeavingLeavesNothingBehind) {
  ASSERT_TRUE(a_.store->create_simulation(simulation("x"), {}).ok());
  a_.ownership->leave();
  EXPECT_FALSE(a_.ownership->is_held());
  EXPECT_FALSE(a_.ownership->renew().ok());
  EXPECT_THAT(*b_.ownership->list_orphans(), ElementsAre(Field(&Orphan::simulation, "x")));
  EXPECT_EQ(b_.ownership->list_daemons()->size(), 1u);
}

TEST_F(OwnershipTest, APassedLeaseTakesNothing) {
  ASSERT_TRUE(a_.store->create_simulation(simulation("x"), {}).ok());
  a_.end_lease(place_);
  b_.ownership->tenures()->extend({});
  EXPECT_TRUE(absl::IsUnavailable(b_.ownership->take("x")));
  EXPECT_EQ((*a_.ownership->owner_of("x"))->name, "a");
}

TEST_F(OwnershipTest, AStartUnderTheNameOfADeadOneSucceedsIt) {
  ASSERT_TRUE(a_.store->create_simulation(simulation("x"), {}).ok());
  const auto other = Ownership::open(place_);
  ASSERT_TRUE((*other)->join(a_.directory, "1.0").ok());
  EXPECT_THAT(*(*other)->list_orphans(), ElementsAre(Field(&Orphan::simulation, "x")));
  const auto renewed = a_.ownership->renew();
  EXPECT_TRUE(absl::IsFailedPrecondition(renewed.status())) << renewed.status();
  EXPECT_THAT(std::string(renewed.status().message()), HasSubstr("under the name a"));
}

TEST_F(OwnershipTest, AnotherDirectoryIsRefused) {
  const auto elsewhere = DataDirectory::open_shared(directory_.file("other"), "c");
  const auto joined = (*Ownership::open(place_))->join(*elsewhere, "1.0");
  EXPECT_TRUE(absl::IsFailedPrecondition(joined.status()));
  EXPECT_THAT(std::string(joined.status().message()), HasSubstr("the daemon a serves"));
  // A copy knows which daemons there are, and no more what they do.
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(a_.ownership->renew().ok());
  a_.keep_lease(place_);
  std::ofstream(directory_.path() / "data" / "daemons" / "a") << a_.ownership->tenures()->daemon() << " 1\n";
  const auto copy = DataDirectory::open_shared(data_, "c");
  EXPECT_TRUE(absl::IsFailedPrecondition((*Ownership::open(place_))->join(*copy, "1.0").status()));
}

TEST_F(OwnershipTest, ADirectoryThatHasGoneEndsTheLease) {
  std::filesystem::remove(directory_.path() / "data" / "daemons" / "a");
  const auto renewed = a_.ownership->renew();
  EXPECT_TRUE(absl::IsFailedPrecondition(renewed.status()));
  EXPECT_THAT(std::string(renewed.status().message()), HasSubstr("has gone"));
}

TEST(SharedDirectoryTest, IsSharedByNamesAndWithNobodyElse) {
  const lipofill::testing::TemporaryDirectory directory;
  const std::string data = directory.file("data");
  const auto a = DataDirectory::open_shared(data, "a"), b = DataDirectory::open_shared(data, "b");
  EXPECT_TRUE(a.ok() && b.ok());
  EXPECT_THAT(std::string(DataDirectory::open_shared(data, "a").status().message()), HasSubstr("by --name"));
  EXPECT_THAT(std::string(DataDirectory::open(data).status().message()), HasSubstr("is in use by another lipofilld"));
  const std::string alone = directory.file("alone");
  const auto owner = DataDirectory::open(alone);
  EXPECT_THAT(std::string(DataDirectory::open_shared(alone, "a").status().message()), HasSubstr("does not share it"));
}

TEST(SharedDirectoryTest, NamesAreOfFewCharacters) {
  for (const char* good : {"a", "db-1.example:50061", "A_9"}) EXPECT_TRUE(is_daemon_name(good)) << good;
  for (const char* bad : {"", ".", "..", "-a", "a/b", "a b", "\xc3\xa4"}) EXPECT_FALSE(is_daemon_name(bad)) << bad;
  EXPECT_FALSE(is_daemon_name(std::string(65, 'a')));
}

}  // namespace
}  // namespace lipofill::server
