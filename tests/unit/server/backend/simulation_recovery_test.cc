#include "server/backend/simulation_recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "server/backend/parking.h"
#include "server/store/sqlite_database.h"
#include "server/wire/simulation_conversion.h"
#include "tests/unit/server/backend/backend_fixture.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

constexpr char kMore[] = "zone: 'all' volume_ml: 0.02 rate_ml_per_s: 1";

class RecoveryTest : public BackendTest {
 protected:
  absl::StatusOr<SessionView> inject(const std::string& id) {
    const auto message = parse<v1::Injection>(kMore);
    const auto spec = to_injection_spec(message);
    return ask(id, [&](Session& session, auto reply) {
      session.inject({*spec, message.SerializeAsString()}, {}, std::move(reply));
    });
  }
  absl::StatusOr<SessionView> pause(const std::string& id) {
    return ask(id, [](Session& session, auto reply) { session.pause({}, std::move(reply)); });
  }
  template <typename Act>
  absl::StatusOr<SessionView> ask(const std::string& id, Act&& act) {
    const auto session = backend_->sessions.hold(id);
    if (session == nullptr) return absl::NotFoundError(id);
    return await<absl::StatusOr<SessionView>>([&](auto reply) { act(*session, std::move(reply)); });
  }
  /// Runs it until so many steps are taken, and pauses it there or later.
  SessionView run_to(const std::string& id, uint64_t step) {
    EXPECT_TRUE(ask(id, [](Session& session, auto reply) { session.start({}, std::move(reply)); }).ok());
    while (backend_->sessions.find(id)->cached_view().report.step < step) std::this_thread::yield();
    const auto paused = pause(id);
    EXPECT_TRUE(paused.ok()) << paused.status();
    return paused.ok() ? *paused : SessionView();
  }
  /// Writes over the files of its checkpoints.
  void damage_checkpoints(const std::string& id) {
    int damaged = 0;
    for (const auto& entry : std::filesystem::directory_iterator(directory_.path() / "checkpoints" / id)) {
      std::ofstream(entry.path(), std::ios::trunc) << "nonsense";
      ++damaged;
    }
    ASSERT_GT(damaged, 0);
  }
};

TEST_F(RecoveryTest, APausedOneStandsWhereItStood) {
  create("a", 1e6);
  const SessionView before = run_to("a", 20);
  restart();
  EXPECT_EQ(backend_->sessions.find("a"), nullptr);
  ASSERT_TRUE(bring_back_simulations(*backend_).ok());
  const auto after = inspect("a");
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_EQ(after->state, SimulationState::kPaused);
  EXPECT_EQ(after->report.step, before.report.step);
  EXPECT_EQ(after->state_hash, before.state_hash);
  EXPECT_EQ(after->wall_s, before.wall_s);
}

TEST_F(RecoveryTest, CommandsAfterTheCheckpointAreRepeatedFromTheLog) {
  create("a", 1e6);
  run_to("a", 20);
  const auto injected = inject("a");
  ASSERT_TRUE(injected.ok()) << injected.status();
  begin();  // without a word of farewell: the injection is in the log alone
  ASSERT_TRUE(bring_back_simulations(*backend_).ok());
  // An answer comes only when it has caught up.
  const auto again = inject("a");
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->report.step, injected->report.step);
  v1::SimulationSpec plan;
  ASSERT_TRUE(plan.ParseFromString(record_of("a").spec_message));
  ASSERT_EQ(plan.injections_size(), 3);
  EXPECT_TRUE(plan.injections(1).has_start_s()) << "as it was resolved the first time";
  EXPECT_GT(plan.injections(2).start_s(), plan.injections(1).start_s()) << "it comes after the repeated one";
}

TEST_F(RecoveryTest, ADamagedCheckpointIsLeftOutAndTold) {
  create("a", 1e6);
  const SessionView before = run_to("a", 20);
  ASSERT_TRUE(inject("a").ok());
  restart();
  damage_checkpoints("a");
  ASSERT_TRUE(bring_back_simulations(*backend_).ok());
  const auto asked = inject("a");
  ASSERT_TRUE(asked.ok()) << asked.status();
  EXPECT_EQ(asked->report.step, before.report.step) << "repeated from the start";
  EXPECT_THAT(asked->reason, HasSubstr("goes on from step 0"));
  EXPECT_THAT(asked->reason, HasSubstr("cannot be used"));
}

TEST_F(RecoveryTest, OneWhosePlanIsLostFailsAndTheOthersDoNotSufferFromIt) {
  create("a", 1e6);
  create("b", 1e6);
  ASSERT_TRUE(store_->append_command({"a", 0, CommandKind::kInject, 0, "\xff\xff", 1}, "\xff\xff", {}).ok());
  restart();
  ASSERT_TRUE(bring_back_simulations(*backend_).ok());
  EXPECT_EQ(record_of("a").state, SimulationState::kFailed);
  EXPECT_THAT(record_of("a").reason, HasSubstr("its plan cannot be read"));
  EXPECT_EQ(backend_->sessions.find("a"), nullptr);
  EXPECT_TRUE(inspect("b").ok());
}

TEST_F(RecoveryTest, OneWhoseModelCannotBeBuiltWaitsAndComesBack) {
  create("a", 1e6);
  const SessionView before = run_to("a", 20);
  restart();
  ModelRecord model = *store_->get_model("anna", "m");
  const std::string hash = model.content_hash;
  const auto set_hash = [&](const std::string& text) {
    const auto database = SqliteDatabase::open(directory_.file("db"));
    Query update(**database, "UPDATE models SET content_hash = ?");
    ASSERT_TRUE(update.bind(text).run().ok());
  };
  set_hash("of another program");
  ASSERT_TRUE(bring_back_simulations(*backend_).ok());
  EXPECT_EQ(backend_->sessions.find("a"), nullptr);
  EXPECT_EQ(record_of("a").state, SimulationState::kPaused) << "what it was told to be stays so";
  ASSERT_TRUE(backend_->awaited.find("a").has_value());
  EXPECT_THAT(backend_->awaited.find("a")->waiting_for, HasSubstr("built again it is"));
  EXPECT_EQ(backend_->awaited.find("a")->until_step, before.report.step);
  const v1::Simulation shown = show_without_session(*backend_, record_of("a"));
  EXPECT_EQ(shown.recovery().attempts(), 1u);
  EXPECT_EQ(shown.recovery().until_step(), before.report.step);
  EXPECT_TRUE(absl::IsUnavailable(find_or_wake(*backend_, "a").status()));
  try_to_bring_back(*backend_, "a");
  EXPECT_EQ(backend_->awaited.find("a")->attempts, 2u);
  set_hash(hash);
  try_to_bring_back(*backend_, "a");
  EXPECT_FALSE(backend_->awaited.find("a").has_value());
  EXPECT_EQ(inspect("a")->state_hash, before.state_hash);
}

TEST_F(RecoveryTest, OneThatIsDeletedIsNoLongerAwaited) {
  create("a", 1e6);
  restart();
  backend_->awaited.note("a", "room", 0);
  ASSERT_TRUE(delete_simulation_record(*backend_, "a").ok());
  EXPECT_EQ(backend_->awaited.size(), 0u);
  backend_->awaited.note("gone", "room", 0);
  try_to_bring_back(*backend_, "gone");
  EXPECT_EQ(backend_->awaited.size(), 0u);
}

TEST_F(RecoveryTest, AParkedOneStaysSoUntilItIsWoken) {
  create("a", 1e6);
  const SessionView before = run_to("a", 20);
  park("a");
  restart();
  ASSERT_TRUE(bring_back_simulations(*backend_).ok());
  EXPECT_EQ(backend_->sessions.find("a"), nullptr);
  const auto woken = wake_simulation(*backend_, record_of("a"));
  ASSERT_TRUE(woken.ok()) << woken.status();
  EXPECT_TRUE((*woken)->is_held());
  EXPECT_EQ(inspect("a")->state_hash, before.state_hash);
  EXPECT_TRUE(record_of("a").summary_message.empty()) << "it is parked no more";
}

TEST_F(RecoveryTest, OneIsNotWokenWhereThereIsNoRoom) {
  create("a", 1e6);
  park("a");
  options_.sessions.simulations = 1;
  begin();
  create("b", 1e6);
  const auto refused = wake_simulation(*backend_, record_of("a"));
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status())) << refused.status();
  EXPECT_FALSE(record_of("a").summary_message.empty()) << "it stays parked";
}

}  // namespace
}  // namespace lipofill::server
