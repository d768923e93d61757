#include "server/sessions/idle_clock.h"

#include <gtest/gtest.h>

#include <thread>

namespace lipofill::server {
namespace {

using Clock = IdleClock::Clock;

void let_time_pass() {
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

TEST(IdleClock, StandsAtZeroWhileItIsWatchedOrHeld) {
  IdleClock idle;
  idle.begin_watching();
  idle.hold();
  let_time_pass();
  EXPECT_EQ(idle.idle_time(), Clock::duration::zero());
  idle.end_watching();
  EXPECT_EQ(idle.watchers(), 0);
  EXPECT_TRUE(idle.is_held());
  let_time_pass();
  EXPECT_EQ(idle.idle_time(), Clock::duration::zero()) << "it is still held";
  const auto before = Clock::now();
  idle.let_go();
  EXPECT_FALSE(idle.is_held());
  const Clock::duration idle_time = idle.idle_time();
  EXPECT_LE(idle_time, Clock::now() - before) << "time begins when it is let go of";
  let_time_pass();
  EXPECT_GT(idle.idle_time(), Clock::duration::zero());
}

TEST(IdleClock, BeginsAnewWithEveryUse) {
  IdleClock idle;
  let_time_pass();
  const auto before = Clock::now();
  idle.note_use();
  const Clock::duration idle_time = idle.idle_time();
  EXPECT_LE(idle_time, Clock::now() - before);
}

}  // namespace
}  // namespace lipofill::server
