// Commands and checkpoints in the store: what a restart goes by.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "server/store/sql_store.h"
#include "tests/unit/server/store/store_kinds.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CommandLogTest : public ::testing::TestWithParam<StoreKind> {
 protected:
  CommandLogTest() {
    reopen();
    SimulationRecord record;
    record.id = "x";
    record.model = "patients/anna/models/m";
    record.spec_message = "plan";
    EXPECT_TRUE(store_->create_simulation(record, {}).ok());
  }
  void reopen() {
    store_ = nullptr;
    auto store = SqlStore::open(place_);
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
  }
  absl::StatusOr<bool> append(CommandKind kind, uint64_t step, const std::string& payload = "",
                              const std::string& spec = "", const RequestKey& key = {}) {
    return store_->append_command({"x", 0, kind, step, payload, 5}, spec, key);
  }
  absl::StatusOr<CheckpointRecord> checkpoint(const std::string& id, uint64_t step,
                                              CheckpointKind kind = CheckpointKind::kAutomatic,
                                              const std::optional<SeriesChunk>& rows = {}) {
    CheckpointRecord record;
    record.simulation = "x";
    record.id = id;
    record.kind = kind;
    record.step = step;
    record.time_s = 0.01 * static_cast<double>(step);
    record.size_bytes = 1000;
    record.sha256 = "ab";
    record.create_time_us = static_cast<int64_t>(step);
    return store_->create_checkpoint(record, rows, {});
  }
  std::vector<std::string> log() {
    std::vector<std::string> lines;
    const auto commands = store_->list_commands("x");
    for (const CommandRecord& command : commands.value()) {
      lines.push_back(absl::StrCat(command.number, ":", static_cast<int>(command.kind), "@", command.step));
    }
    return lines;
  }
  std::vector<std::string> checkpoints() {
    std::vector<std::string> ids;
    const auto records = store_->list_checkpoints("x", {"", 100});
    for (const CheckpointRecord& record : records.value()) {
      ids.push_back(record.id + (record.on_course ? "" : " off"));
    }
    return ids;
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::string place_ = make_place(GetParam(), directory_);
  std::unique_ptr<SqlStore> store_;
};

TEST_P(CommandLogTest, KeepsCommandsInOrderWithTheStateAndThePlanTheyMake) {
  ASSERT_TRUE(*append(CommandKind::kStart, 0));
  ASSERT_TRUE(*append(CommandKind::kInject, 7, "more fat", "plan with more"));
  EXPECT_EQ(store_->get_simulation("x")->state, SimulationState::kRunning);
  ASSERT_TRUE(*append(CommandKind::kPause, 9));
  reopen();
  EXPECT_THAT(log(), ElementsAre("1:1@0", "2:5@7", "3:2@9"));
  EXPECT_EQ(store_->list_commands("x")->at(1).payload, "more fat");
  EXPECT_EQ(store_->get_simulation("x")->state, SimulationState::kPaused);
  EXPECT_EQ(store_->get_simulation("x")->spec_message, "plan with more");
  // A simulation has ended once its result is there.
  ASSERT_TRUE(*append(CommandKind::kStop, 9));
  EXPECT_EQ(store_->get_simulation("x")->state, SimulationState::kPaused);
}

TEST_P(CommandLogTest, ARepeatedRequestChangesNothing) {
  const RequestKey key{"Inject", "r1", "f1"};
  ASSERT_TRUE(*append(CommandKind::kInject, 7, "fat", "plan 2", key));
  reopen();
  EXPECT_FALSE(*append(CommandKind::kInject, 8, "fat", "plan 3", key));
  EXPECT_EQ(log().size(), 1u);
  EXPECT_EQ(store_->get_simulation("x")->spec_message, "plan 2");
  EXPECT_TRUE(absl::IsInvalidArgument(append(CommandKind::kInject, 8, "", "", {"Inject", "r1", "f2"}).status()));
}

TEST_P(CommandLogTest, NothingIsKeptOfASimulationThatIsGone) {
  ASSERT_TRUE(*append(CommandKind::kStart, 0));
  ASSERT_TRUE(checkpoint("c1", 3).ok());
  ASSERT_TRUE(store_->delete_simulation("x").ok());
  EXPECT_TRUE(absl::IsNotFound(append(CommandKind::kPause, 9).status()));
  EXPECT_TRUE(absl::IsNotFound(checkpoint("c2", 9).status()));
  EXPECT_TRUE(absl::IsNotFound(store_->get_checkpoint("x", "c1").status()));
  EXPECT_TRUE(store_->list_commands("x")->empty());
  EXPECT_EQ(*store_->count_checkpoint_bytes(), 0u);
}

TEST_P(CommandLogTest, ACheckpointKnowsWhichCommandsAreInIt) {
  ASSERT_TRUE(*append(CommandKind::kStart, 0));
  ASSERT_TRUE(*append(CommandKind::kInject, 7));
  ASSERT_TRUE(checkpoint("c1", 10, CheckpointKind::kAsked, SeriesChunk{1, 10, "rows"}).ok());
  ASSERT_TRUE(*append(CommandKind::kInject, 12));
  reopen();
  const auto kept = store_->get_checkpoint("x", "c1");
  ASSERT_TRUE(kept.ok());
  EXPECT_EQ(kept->last_command, 2u);
  EXPECT_EQ(kept->time_s, 0.01 * 10);
  EXPECT_EQ(kept->kind, CheckpointKind::kAsked);
  EXPECT_EQ((**store_->next_series_chunk("x", 0)).rows_message, "rows");
  EXPECT_TRUE(absl::IsAlreadyExists(checkpoint("c1", 11).status()));
}

TEST_P(CommandLogTest, KeepsTheNewestFew) {
  for (uint64_t i = 1; i <= 5; ++i) ASSERT_TRUE(checkpoint(absl::StrCat("c", i), i).ok());
  ASSERT_TRUE(checkpoint("asked", 1, CheckpointKind::kAsked).ok());
  ASSERT_TRUE(store_->prune_checkpoints("x", 2).ok());
  EXPECT_THAT(checkpoints(), ElementsAre("asked", "c4", "c5"));
  EXPECT_EQ(*store_->count_checkpoint_bytes(), 3000u);
  ASSERT_TRUE(store_->delete_checkpoint("x", "asked").ok());
  EXPECT_TRUE(absl::IsNotFound(store_->delete_checkpoint("x", "asked")));
  SimulationRecord ended;
  ended.id = "x";
  ended.state = SimulationState::kSettled;
  ASSERT_TRUE(checkpoint("asked", 6, CheckpointKind::kAsked).ok());
  ASSERT_TRUE(store_->end_simulation(ended, {}).ok());
  EXPECT_THAT(checkpoints(), ElementsAre("asked"));
}

TEST_P(CommandLogTest, ARestoreTakesWhatCameAfterOffCourse) {
  ASSERT_TRUE(*append(CommandKind::kStart, 0));
  ASSERT_TRUE(checkpoint("c1", 5, CheckpointKind::kAutomatic, SeriesChunk{1, 5, "to 5"}).ok());
  ASSERT_TRUE(*append(CommandKind::kInject, 5, "a", "plan a"));
  ASSERT_TRUE(checkpoint("c2", 10, CheckpointKind::kAsked, SeriesChunk{6, 10, "to 10"}).ok());
  ASSERT_TRUE(*append(CommandKind::kInject, 12, "b", "plan a b"));
  ASSERT_TRUE(checkpoint("c3", 20, CheckpointKind::kAsked, SeriesChunk{11, 20, "to 20"}).ok());
  const RequestKey key{"Restore", "r", "f"};
  const CommandRecord restore{"x", 0, CommandKind::kRestore, 10, "c2", 5};
  ASSERT_TRUE(*store_->restore_simulation(restore, SimulationState::kRunning, "plan a", key));
  EXPECT_FALSE(*store_->restore_simulation(restore, SimulationState::kRunning, "plan a", key));
  EXPECT_THAT(log(), ElementsAre("1:1@0", "2:5@5", "4:6@10", "5:3@10"));
  EXPECT_THAT(checkpoints(), ElementsAre("c1", "c2", "c3 off"));
  EXPECT_EQ(store_->get_simulation("x")->spec_message, "plan a");
  EXPECT_EQ((**store_->next_series_chunk("x", 9)).last_step, 10u);
  EXPECT_FALSE(store_->next_series_chunk("x", 10)->has_value());

  // Further back still is on course, forth to what was left is not.
  const CommandRecord forth{"x", 0, CommandKind::kRestore, 20, "c3", 5};
  const absl::Status refused = store_->restore_simulation(forth, SimulationState::kPaused, "plan a b", {}).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("simulations/x/checkpoints/c3"));
  const CommandRecord back{"x", 0, CommandKind::kRestore, 5, "c1", 5};
  ASSERT_TRUE(*store_->restore_simulation(back, SimulationState::kPaused, "plan", {}));
  EXPECT_THAT(log(), ElementsAre("1:1@0", "6:6@5", "7:2@5"));
  EXPECT_THAT(checkpoints(), ElementsAre("c1", "c2 off", "c3 off"));
  EXPECT_EQ(store_->get_simulation("x")->state, SimulationState::kPaused);
}

TEST_P(CommandLogTest, HoldsOnToWhatASimulationBeganFrom) {
  SimulationRecord made;
  made.id = "y";
  made.origin = "simulations/x/checkpoints/c1";
  CheckpointRecord origin;
  origin.simulation = "y";
  origin.id = "origin";
  origin.kind = CheckpointKind::kOrigin;
  origin.step = 8;
  const RequestKey key{"Restore", "r", "f"};
  ASSERT_TRUE(store_->create_simulation_from(made, origin, key).ok());
  SimulationRecord other = made;
  other.id = "z";
  EXPECT_EQ(store_->create_simulation_from(other, origin, key)->id, "y");
  reopen();
  EXPECT_EQ(store_->get_simulation("y")->origin, made.origin);
  ASSERT_TRUE(store_->prune_checkpoints("y", 0).ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(store_->delete_checkpoint("y", "origin")));
  made.state = SimulationState::kStopped;
  ASSERT_TRUE(store_->end_simulation(made, {}).ok());
  EXPECT_TRUE(store_->delete_checkpoint("y", "origin").ok());
}

TEST_P(CommandLogTest, EpochsOnlyRise) {
  SimulationRecord made;
  made.id = "made";
  made.create_time_us = 5000;
  ASSERT_TRUE(store_->create_simulation(made, {}).ok());
  EXPECT_EQ(*store_->begin_epoch("made", 10), 5001u) << "its first is the time when it was made";
  const uint64_t first = *store_->begin_epoch("x", 1000);
  EXPECT_EQ(first, 1000u);
  EXPECT_EQ(*store_->begin_epoch("x", 500), 1001u) << "the clock went back";
  reopen();
  EXPECT_EQ(*store_->begin_epoch("x", 2000), 2000u);
  EXPECT_TRUE(absl::IsNotFound(store_->begin_epoch("none", 1).status()));
}

INSTANTIATE_TEST_SUITE_P(EveryKind, CommandLogTest, ::testing::Values(StoreKind::kSqlite, StoreKind::kPostgres),
                         kind_name);

}  // namespace
}  // namespace lipofill::server
