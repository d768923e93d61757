// A session that keeps its state, goes back, and is brought back after the end of its daemon.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <thread>

#include "tests/unit/server/sessions/session_fixture.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr plan::TimeGoal kTransient = plan::TimeGoal::kTransient;
constexpr double kEnd_s = 3.0;  // 300 steps

plan::InjectionSpec more() {
  return {"all", 2e-8, 1e-6, std::nullopt, std::nullopt};
}

/// The hash after 300 steps, with `more` injected after the steps given.
std::string hash_of_an_unbroken_run(const std::vector<uint64_t>& injected_at) {
  const auto simulation = make_simulation(kEnd_s);
  EXPECT_EQ(simulation->spec().goal, kTransient);
  while (simulation->phase() == simulation::Phase::kRunning) {
    for (const uint64_t step : injected_at) {
      if (step != simulation->report().step) continue;
      EXPECT_TRUE(simulation->inject(more()).ok());
    }
    simulation->advance_step();
  }
  return simulation->state_hash();
}

class SessionResumeTest : public SessionTest {
 protected:
  std::shared_ptr<Session> session(std::unique_ptr<simulation::Simulation> simulation, SessionHistory history = {},
                                   double interval_s = 0.0) {
    SessionOptions chosen = options("a");
    chosen.checkpoint_interval_s = interval_s;
    auto made = std::make_shared<Session>(chosen, std::move(simulation), workers_, sink_, std::move(history));
    made->go_on();
    return made;
  }
  /// A simulation after so many steps.
  std::unique_ptr<simulation::Simulation> at_step(uint64_t step, double end_s = kEnd_s) {
    auto simulation = make_simulation(end_s);
    while (simulation->report().step < step) simulation->advance_step();
    return simulation;
  }
  absl::StatusOr<SessionView> inject(Session& s, const RequestKey& key = {}) {
    return ask([&](auto reply) { s.inject({more(), "message"}, key, reply); });
  }
  SessionView await(const Session& s, SimulationState state, uint64_t step) {
    for (int i = 0; i < 20'000; ++i) {
      const SessionView view = s.cached_view();
      if (view.state == state && view.report.step >= step) return view;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "is " << state_name(s.cached_view().state) << " at step " << s.cached_view().report.step;
    return {};
  }
};

TEST_F(SessionResumeTest, EveryCommandIsKeptWithItsStepBeforeItIsAnswered) {
  const auto s = session(make_simulation(1e6));
  ASSERT_TRUE(inject(*s).ok());
  ASSERT_TRUE(start(*s).ok());
  const auto paused = pause(*s);
  ASSERT_TRUE(paused.ok());
  ASSERT_TRUE(inject(*s).ok());
  ASSERT_TRUE(ask([&](auto reply) { s->resume({}, reply); }).ok());
  ASSERT_TRUE(ask([&](auto reply) { s->stop("enough", {}, reply); }).ok());
  std::vector<CommandKind> kinds;
  for (const CommandRecord& command : sink_.commands) kinds.push_back(command.kind);
  EXPECT_THAT(kinds, ElementsAre(CommandKind::kInject, CommandKind::kStart, CommandKind::kPause, CommandKind::kInject,
                                 CommandKind::kResume, CommandKind::kStop));
  EXPECT_EQ(sink_.commands[2].step, paused->report.step);
  EXPECT_EQ(sink_.commands[3].step, paused->report.step);
  EXPECT_EQ(sink_.commands[5].payload, "enough");
  EXPECT_NEAR(sink_.starts.at(0), 0.1, 1e-12) << "after the plan's own";
}

TEST_F(SessionResumeTest, WhatCannotBeKeptIsNotDone) {
  const auto s = session(make_simulation(1e6));
  ASSERT_TRUE(start(*s).ok());
  {
    const std::lock_guard lock(sink_.mutex);
    sink_.room = absl::ResourceExhaustedError("the disk is full");
  }
  const auto refused = pause(*s);
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status()));
  EXPECT_TRUE(absl::IsResourceExhausted(inject(*s).status()));
  EXPECT_EQ(s->cached_view().state, SimulationState::kRunning) << "it goes on";
  {
    const std::lock_guard lock(sink_.mutex);
    sink_.room = absl::OkStatus();
  }
  const auto paused = pause(*s);
  ASSERT_TRUE(paused.ok());
  EXPECT_EQ(sink_.commands.size(), 2u);
}

TEST_F(SessionResumeTest, ARepeatedRequestIsAnsweredAndNotRepeated) {
  const auto s = session(make_simulation(1e6));
  ASSERT_TRUE(inject(*s, {"inject", "r1", ""}).ok());
  ASSERT_TRUE(inject(*s, {"inject", "r1", ""}).ok());
  EXPECT_EQ(sink_.commands.size(), 1u);
  ASSERT_TRUE(ask([&](auto reply) { s->start({"start", "r2", ""}, reply); }).ok());
  ASSERT_TRUE(ask([&](auto reply) { s->start({"start", "r2", ""}, reply); }).ok()) << "though it is RUNNING now";
  EXPECT_EQ(sink_.commands.size(), 2u);
}

TEST_F(SessionResumeTest, ABroughtBackRunEndsLikeAnUnbrokenOne) {
  for (const uint64_t from : {0, 1, 57, 120}) {
    SessionHistory history;
    history.state = SimulationState::kRunning;
    history.injections = {{120, more()}, {120, more()}, {201, more()}};
    history.until_step = 201;
    const auto s = session(at_step(from), history);
    const SessionView ended = await(*s, SimulationState::kFinished, 300);
    EXPECT_EQ(inspect(*s)->state_hash, hash_of_an_unbroken_run({120, 120, 201})) << from << ended.reason;
  }
}

TEST_F(SessionResumeTest, APausedOneCatchesUpAndStandsWhereItStood) {
  SessionHistory history;
  history.state = SimulationState::kPaused;
  history.injections = {{40, more()}};
  history.until_step = 90;
  const auto s = session(at_step(30), history);
  EXPECT_EQ(s->cached_view().state, SimulationState::kPaused) << "from the first moment on";
  // A command meanwhile waits its turn.
  const auto injected = inject(*s);
  ASSERT_TRUE(injected.ok());
  EXPECT_EQ(injected->report.step, 90u);
  EXPECT_EQ(sink_.commands.at(0).step, 90u);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(inspect(*s)->report.step, 90u);
  ASSERT_TRUE(ask([&](auto reply) { s->resume({}, reply); }).ok());
  await(*s, SimulationState::kFinished, 300);
  EXPECT_EQ(inspect(*s)->state_hash, hash_of_an_unbroken_run({40, 90}));
}

TEST_F(SessionResumeTest, KeepsItsStateWhileItCatchesUpWithTheCommandsThatAreInIt) {
  SessionHistory history;
  history.state = SimulationState::kRunning;
  history.was_there = true;
  history.last_command = 1;
  history.commands = {{2, 1200}, {3, 1200}, {4, 2500}};
  history.injections = {{1200, more()}, {1200, more()}};
  history.until_step = 2500;
  const auto s = session(at_step(0, 40.0), history, 1e-4);
  EXPECT_EQ(s->cached_view().catching_up_to.value_or(2500), 2500u);
  const SessionView ended = await(*s, SimulationState::kFinished, 4000);
  EXPECT_FALSE(ended.catching_up_to.has_value());
  workers_.stop();
  int meanwhile = 0;
  for (const MemorySink::Kept& kept : sink_.checkpoints) {
    const uint64_t step = kept.record.step, last = kept.record.last_command;
    meanwhile += step < 2500 ? 1 : 0;
    // The injections after step 1200 are in the states that follow; in the end all commands are.
    const uint64_t expected = step <= 1200 ? 1 : step <= 2500 ? 3 : 0;
    EXPECT_TRUE(step == 2500 || last == expected) << step << ": " << last;
  }
  EXPECT_GT(meanwhile, 1);
}

TEST_F(SessionResumeTest, AStopThatWasAcknowledgedTakesEffectAtItsStep) {
  SessionHistory history;
  history.state = SimulationState::kRunning;
  history.until_step = 77;
  history.stop_reason = "stopped by a client";
  const auto s = session(at_step(50), history);
  const SessionView stopped = await(*s, SimulationState::kStopped, 77);
  EXPECT_EQ(stopped.report.step, 77u);
  EXPECT_EQ(stopped.reason, "stopped by a client");
  EXPECT_EQ(inspect(*s)->state_hash, at_step(77)->state_hash());
  EXPECT_TRUE(sink_.commands.empty()) << "it is in the log already";
}

TEST_F(SessionResumeTest, ALogThatDoesNotFitIsAFailureWithItsReason) {
  SessionHistory history;
  history.state = SimulationState::kRunning;
  history.injections = {{40, more()}};
  history.until_step = 60;
  const auto s = session(at_step(50), history);
  EXPECT_THAT(await(*s, SimulationState::kFailed, 50).reason, HasSubstr("at step 50"));
}

TEST_F(SessionResumeTest, KeepsItsStateAsItRunsAndGoesOnFromEach) {
  constexpr double kLonger_s = 40.0;
  const auto s = session(make_simulation(kLonger_s), {}, 1e-4);
  ASSERT_TRUE(start(*s).ok());
  await(*s, SimulationState::kFinished, 4000);
  workers_.stop();
  ASSERT_GT(sink_.checkpoints.size(), 1u);
  std::vector<uint64_t> every_step(4000);
  std::iota(every_step.begin(), every_step.end(), uint64_t{1});
  EXPECT_EQ(sink_.steps, every_step) << "each row once, with the checkpoint or at the end";
  const std::string hash = sink_.views.at("a").state_hash;
  for (const MemorySink::Kept& kept : sink_.checkpoints) {
    auto simulation = make_simulation(kLonger_s);
    ASSERT_TRUE(simulation->restore(kept.snapshot).ok());
    EXPECT_EQ(simulation->report().step, kept.record.step);
    EXPECT_EQ(simulation->state_hash(), kept.record.state_hash);
    while (simulation->phase() == simulation::Phase::kRunning) simulation->advance_step();
    EXPECT_EQ(simulation->state_hash(), hash);
  }
}

TEST_F(SessionResumeTest, KeepsItsStateRarelyWhereThatIsSlow) {
  sink_.checkpoint_time = std::chrono::milliseconds(2);
  const auto s = session(make_simulation(1e6), {}, 1e-4);
  ASSERT_TRUE(start(*s).ok());
  for (size_t kept = 0; kept < 3;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::lock_guard lock(sink_.mutex);
    kept = sink_.checkpoints.size();
  }
  ASSERT_TRUE(ask([&](auto reply) { s->stop("", {}, reply); }).ok());
  for (size_t i = 1; i < 3; ++i) {
    const int64_t apart_us =
        sink_.checkpoints[i].record.create_time_us - sink_.checkpoints[i - 1].record.create_time_us;
    EXPECT_GE(apart_us, 100 * 2000) << "at most a hundredth of the run";
  }
}

TEST_F(SessionResumeTest, SaysThatItCannotKeepItsStateAndGoesOn) {
  sink_.room = absl::OkStatus();
  const auto s = session(make_simulation(1e6), {}, 1e-4);
  ASSERT_TRUE(start(*s).ok());
  {
    const std::lock_guard lock(sink_.mutex);
    sink_.room = absl::ResourceExhaustedError("the disk is full");
  }
  while (s->cached_view().reason.find("the disk is full") == std::string::npos) std::this_thread::yield();
  EXPECT_EQ(s->cached_view().state, SimulationState::kRunning);
  {
    const std::lock_guard lock(sink_.mutex);
    sink_.room = absl::OkStatus();
  }
  while (!s->cached_view().reason.empty()) std::this_thread::yield();
  ASSERT_TRUE(ask([&](auto reply) { s->stop("", {}, reply); }).ok());
  EXPECT_TRUE(std::is_sorted(sink_.steps.begin(), sink_.steps.end()));
  EXPECT_EQ(sink_.steps.size(), sink_.views.at("a").report.step) << "rows waited for room";
}

TEST_F(SessionResumeTest, AResultThatFindsNoRoomIsKeptWhenThereIsSome) {
  const auto s = session(make_simulation(kEnd_s));
  ASSERT_TRUE(start(*s).ok());
  {
    const std::lock_guard lock(sink_.mutex);
    sink_.room = absl::ResourceExhaustedError("the disk is full");
  }
  await(*s, SimulationState::kFinished, 300);
  EXPECT_EQ(inspect(*s)->state_hash, hash_of_an_unbroken_run({})) << "shown all the same";
  EXPECT_TRUE(sink_.views.empty());
  {
    const std::lock_guard lock(sink_.mutex);
    sink_.room = absl::OkStatus();
  }
  ASSERT_TRUE(inspect(*s).ok());
  EXPECT_EQ(sink_.views.at("a").report.step, 300u);
  EXPECT_EQ(sink_.steps.size(), 300u);
}

TEST_F(SessionResumeTest, GoesBackToACheckpointInANewEpoch) {
  const auto s = session(make_simulation(1e6));
  ViewerOptions every;
  every.delivery = Delivery::kEvery;
  every.interval_s = 0.2;
  const auto viewer = std::make_shared<Viewer>(every, [] {});
  s->watch(viewer);
  ASSERT_TRUE(start(*s).ok());
  const auto kept = ask<CheckpointRecord>([&](auto reply) { s->checkpoint("c1", {}, reply); });
  ASSERT_TRUE(kept.ok()) << kept.status();
  await(*s, SimulationState::kRunning, kept->step + 100);
  ASSERT_TRUE(inject(*s).ok());
  auto earlier = make_simulation(1e6);
  ASSERT_TRUE(earlier->restore(sink_.checkpoints.at(0).snapshot).ok());
  auto order = std::make_shared<RestoreOrder>(RestoreOrder{*kept, std::move(earlier), "plan"});
  ASSERT_TRUE(pause(*s).ok());
  const auto back = ask([&](auto reply) { s->restore(std::move(*order), {}, reply); });
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->report.step, kept->step);
  EXPECT_EQ(back->state_hash, kept->state_hash);
  EXPECT_EQ(back->state, SimulationState::kPaused);
  EXPECT_TRUE(s->pending_series(0).empty());
  EXPECT_EQ(sink_.commands.back().kind, CommandKind::kRestore);

  std::vector<std::pair<uint64_t, uint64_t>> frames;  // epoch, sequence
  for (ToSend next = viewer->take(); !std::holds_alternative<std::monostate>(next); next = viewer->take()) {
    if (const auto* f = std::get_if<FrameToSend>(&next)) frames.emplace_back(f->frame->epoch, f->frame->sequence);
  }
  EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end())) << "sequences rise within an epoch";
  EXPECT_EQ(frames.back(), std::make_pair(uint64_t{101}, kept->step)) << "though its time was shown before";
}

}  // namespace
}  // namespace lipofill::server
