#include "server/sessions/session_manager.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "core/base/error_hints.h"
#include "tests/unit/server/sessions/session_fixture.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

TEST_F(SessionTest, TheManagerBoundsAndStopsAll) {
  SessionManager manager({.simulations = 2});
  for (const char* id : {"a", "b"}) {
    auto place = manager.reserve("clinic");
    ASSERT_TRUE(place.ok());
    const auto s = session(id, 1e6);
    ASSERT_TRUE(manager.add(*std::move(place), s));
    ASSERT_TRUE(start(*s).ok());
  }
  const auto refused = manager.reserve("clinic");
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status()));
  EXPECT_THAT(refused.status().ToString(), HasSubstr("bound is 2"));
  manager.remove("b");
  EXPECT_TRUE(manager.reserve("clinic").ok()) << "given back when it is not used";
  const auto a = manager.find("a");
  const auto viewer = std::make_shared<Viewer>(ViewerOptions{}, [] {});
  a->watch(viewer);
  while (a->cached_view().report.step == 0) std::this_thread::yield();
  EXPECT_FALSE(viewer->closed());
  manager.suspend_all();
  EXPECT_TRUE(viewer->closed());
  EXPECT_EQ(a->cached_view().state, SimulationState::kRunning) << "it is to go on";
  const uint64_t step = inspect(*a)->report.step;
  ASSERT_EQ(sink_.checkpoints.size(), 1u);
  EXPECT_EQ(sink_.checkpoints.back().record.step, step);
  EXPECT_TRUE(absl::IsUnavailable(pause(*a).status()));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(inspect(*a)->report.step, step);
  EXPECT_TRUE(absl::IsUnavailable(manager.reserve("clinic").status()));
}

TEST_F(SessionTest, TheManagerBoundsEachTenant) {
  SessionManager manager({.simulations = 10, .simulations_per_tenant = 1});
  auto first = manager.reserve("clinic");
  ASSERT_TRUE(first.ok());
  const auto refused = manager.reserve("clinic");
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status()));
  EXPECT_EQ(hints_of(refused.status())->reason, "TOO_MANY_SIMULATIONS_OF_TENANT");
  EXPECT_TRUE(hints_of(refused.status())->retry_delay_s.has_value());
  EXPECT_TRUE(manager.reserve("practice").ok());
}

TEST_F(SessionTest, OneThatIsHeldIsNotParked) {
  SessionManager manager({});
  ASSERT_TRUE(manager.add(*manager.reserve("clinic"), session("a", 1.0)));
  auto one = manager.hold("a");
  auto other = manager.hold("a");
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  EXPECT_EQ(one->idle_time(), Session::Clock::duration::zero());
  EXPECT_FALSE(manager.remove_unless_held("a"));
  one = nullptr;
  EXPECT_FALSE(manager.remove_unless_held("a"));
  const auto let_go = Session::Clock::now();
  other = nullptr;
  const auto idle = manager.find("a")->idle_time();
  EXPECT_LE(idle, Session::Clock::now() - let_go) << "as if something was asked just now";
  EXPECT_TRUE(manager.remove_unless_held("a"));
  EXPECT_EQ(manager.hold("a"), nullptr);
}

TEST_F(SessionTest, TheManagerBoundsMemory) {
  SessionManager manager({.memory_bytes = 100});
  {
    auto place = manager.reserve("clinic");
    ASSERT_TRUE(place.ok());
    EXPECT_TRUE(place->claim(60).ok());
    ASSERT_TRUE(manager.add(*std::move(place), session("a", 1.0)));
  }
  EXPECT_EQ(manager.memory_bytes(), 60u);
  {
    auto place = manager.reserve("clinic");
    ASSERT_TRUE(place.ok());
    const absl::Status refused = place->claim(41);
    EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
    EXPECT_EQ(hints_of(refused)->reason, "NO_MEMORY");
    EXPECT_TRUE(place->claim(40).ok());
    EXPECT_EQ(manager.memory_bytes(), 100u);
  }
  EXPECT_EQ(manager.memory_bytes(), 60u) << "given back when it is not used";
  manager.remove("a");
  EXPECT_EQ(manager.memory_bytes(), 0u);
  auto place = manager.reserve("clinic");
  ASSERT_TRUE(place.ok());
  EXPECT_FALSE(place->claim(~uint64_t{0}).ok());
}

/// One simulation at a time.
class QueueTest : public SessionTest {
 protected:
  std::shared_ptr<Session> queued(const std::string& id, double end_s, bool real_time = false) {
    return std::make_shared<Session>(options(id, real_time), make_simulation(end_s), narrow_, sink_);
  }
  WorkerPool narrow_{2, 1};
};

TEST_F(QueueTest, SessionsWaitForTheirTurnAndTakeCommandsMeanwhile) {
  const auto first = queued("a", 1e6, true);
  const auto second = queued("b", 0.05);
  const auto third = queued("c", 0.05);
  for (const auto& s : {first, second, third}) ASSERT_TRUE(start(*s).ok());
  EXPECT_EQ(first->cached_view().queue_position, 0u);
  EXPECT_EQ(second->cached_view().queue_position, 1u);
  EXPECT_EQ(third->cached_view().queue_position, 2u);
  EXPECT_EQ(second->cached_view().state, SimulationState::kRunning);
  ASSERT_TRUE(pause(*second).ok());
  EXPECT_EQ(second->cached_view().queue_position, 0u);
  EXPECT_EQ(third->cached_view().queue_position, 1u);
  ASSERT_TRUE(ask([&](auto reply) { second->resume({}, reply); }).ok());
  EXPECT_EQ(second->cached_view().queue_position, 2u) << "behind those who waited";
  ASSERT_TRUE(ask([&](auto reply) { first->stop("", {}, reply); }).ok());
  await_end(*second);
  await_end(*third);
  EXPECT_EQ(third->cached_view().report.step, 5u);
}

TEST_F(QueueTest, TimeInTheQueueIsNotTimeSpentRunning) {
  const auto first = queued("a", 1e6, true);
  const auto second = queued("b", 1e6, true);
  ASSERT_TRUE(start(*first).ok());
  ASSERT_TRUE(start(*second).ok());
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  EXPECT_EQ(second->cached_view().wall_s, 0.0);
  ASSERT_TRUE(ask([&](auto reply) { first->stop("", {}, reply); }).ok());
  while (second->cached_view().report.step == 0) std::this_thread::yield();
  const auto stopped = ask([&](auto reply) { second->stop("", {}, reply); });
  ASSERT_TRUE(stopped.ok());
  EXPECT_LE(stopped->report.time, stopped->wall_s + 0.011) << "real time begins with the first step";
}

}  // namespace
}  // namespace lipofill::server
