#include "server/sessions/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "tests/unit/server/sessions/session_fixture.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

TEST_F(SessionTest, RunsToTheEndAndKeepsEveryRow) {
  const auto s = session("a", 12.0);
  ASSERT_TRUE(start(*s).ok());
  await_end(*s);
  const auto view = inspect(*s);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view->state, SimulationState::kFinished) << view->reason;
  EXPECT_EQ(view->report.step, 1200u);
  EXPECT_EQ(view->state_hash.size(), 64u);
  workers_.stop();
  EXPECT_EQ(sink_.steps.size(), 1200u);
  EXPECT_TRUE(std::is_sorted(sink_.steps.begin(), sink_.steps.end()));
  EXPECT_EQ(sink_.views.at("a").state_hash, view->state_hash);
  EXPECT_TRUE(s->pending_series(0).empty());
}

TEST_F(SessionTest, GivesTheSameHashBesideOthersPausedOrNot) {
  std::vector<std::shared_ptr<Session>> all;
  for (int i = 0; i < 6; ++i) all.push_back(session(std::to_string(i), 5.0));
  for (const auto& s : all) ASSERT_TRUE(start(*s).ok());
  if (pause(*all[0]).ok()) {
    ASSERT_TRUE(ask([&](auto reply) { all[0]->resume({}, reply); }).ok());
  }
  for (const auto& s : all) await_end(*s);
  const std::string hash = inspect(*all[0])->state_hash;
  for (const auto& s : all) EXPECT_EQ(inspect(*s)->state_hash, hash);
}

TEST_F(SessionTest, NamesTheStateThatDoesNotFit) {
  const auto s = session("a", 1e6);
  EXPECT_THAT(pause(*s).status().ToString(), HasSubstr("READY"));
  ASSERT_TRUE(start(*s).ok());
  const auto again = start(*s);
  EXPECT_TRUE(absl::IsFailedPrecondition(again.status()));
  EXPECT_THAT(again.status().ToString(), HasSubstr("RUNNING"));
  const auto paused = pause(*s);
  ASSERT_TRUE(paused.ok());
  EXPECT_EQ(inspect(*s)->report.step, paused->report.step);
  const auto stopped = ask([&](auto reply) { s->stop("enough", {}, reply); });
  ASSERT_TRUE(stopped.ok());
  EXPECT_EQ(stopped->state, SimulationState::kStopped);
  EXPECT_EQ(stopped->reason, "enough");
  EXPECT_THAT(start(*s).status().ToString(), HasSubstr("STOPPED"));
  EXPECT_EQ(inspect(*s)->state_hash, stopped->state_hash);
}

TEST_F(SessionTest, AnswersManyCommandsFromManyThreads) {
  const auto s = session("a", 1e6);
  ASSERT_TRUE(start(*s).ok());
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) EXPECT_TRUE(inspect(*s).ok());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(ask([&](auto reply) { s->stop("", {}, reply); }).ok());
}

TEST_F(SessionTest, ShowsFramesUntilTheEndAndAfterIt) {
  const auto s = session("a", 0.5);
  ViewerOptions options;
  options.delivery = Delivery::kEvery;
  const auto viewer = std::make_shared<Viewer>(options, [] {});
  s->watch(viewer);
  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(viewer->take()));
  ASSERT_TRUE(start(*s).ok());
  await_end(*s);
  ASSERT_TRUE(inspect(*s).ok());
  for (uint64_t step = 0; step <= 50; ++step) {
    const ToSend next = viewer->take();
    const auto* frame = std::get_if<FrameToSend>(&next);
    ASSERT_NE(frame, nullptr) << step;
    EXPECT_EQ(frame->frame->sequence, step);
    EXPECT_EQ(frame->frame->epoch, 7u);
  }
  EXPECT_TRUE(std::holds_alternative<EndOfStream>(viewer->take()));

  const auto late = std::make_shared<Viewer>(ViewerOptions{}, [] {});
  s->watch(late);
  ASSERT_TRUE(inspect(*s).ok()) << "commands are carried out in order";
  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(late->take()));
  EXPECT_TRUE(std::get<FrameToSend>(late->take()).frame->end);
}

/// Eight viewers at 60 Hz are 480 frames a second: more than that share them, and are due at the
/// same moments.
TEST_F(SessionTest, ManyViewersShareARateUnlessTheyAskForOne) {
  const auto s = session("a", 1e6);
  const auto at = [](int ms) { return Viewer::Clock::time_point(std::chrono::milliseconds(ms)); };
  const auto due_ms_after_a_frame_at = [&](int taken_ms, Viewer& viewer) {
    EXPECT_TRUE(inspect(*s).ok()) << "commands are carried out in order";
    EXPECT_TRUE(std::holds_alternative<TopologyToSend>(viewer.take(at(taken_ms))));
    EXPECT_TRUE(std::holds_alternative<FrameToSend>(viewer.take(at(taken_ms))));
    int ms = taken_ms;
    while (!viewer.wants(0.0, false, at(ms))) ++ms;
    return ms;
  };
  ViewerOptions options;
  options.shares_rate = true;
  std::vector<std::shared_ptr<Viewer>> viewers;
  for (int k = 0; k < 24; ++k) {
    viewers.push_back(std::make_shared<Viewer>(options, [] {}));
    s->watch(viewers.back());
  }
  ViewerOptions own;
  own.max_rate_hz = 200.0;
  const auto fast = std::make_shared<Viewer>(own, [] {});
  s->watch(fast);
  EXPECT_EQ(due_ms_after_a_frame_at(0, *viewers[23]), 50);
  EXPECT_EQ(due_ms_after_a_frame_at(30, *viewers[22]), 50);
  EXPECT_EQ(due_ms_after_a_frame_at(30, *fast), 35);
  while (viewers.size() > 8) {
    s->unwatch(viewers.back());
    viewers.pop_back();
  }
  EXPECT_EQ(due_ms_after_a_frame_at(0, *viewers[0]), 17);
  EXPECT_EQ(due_ms_after_a_frame_at(30, *viewers[1]), 34);
}

TEST_F(SessionTest, StopsWhileItWaitsForRealTime) {
  const auto s = session("a", 1e6, true);
  ASSERT_TRUE(start(*s).ok());
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  const auto stopped = ask([&](auto reply) { s->stop("", {}, reply); });
  ASSERT_TRUE(stopped.ok());
  EXPECT_LE(stopped->report.time, stopped->wall_s + 0.011);
}

}  // namespace
}  // namespace lipofill::server
