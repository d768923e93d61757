#include "server/sessions/run_clock.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

RunClock::Time at(int ms) {
  return RunClock::Time(std::chrono::milliseconds(ms));
}

TEST(RunClock, CountsOnlyWhileItRuns) {
  RunClock clock(2.0);
  EXPECT_FALSE(clock.runs());
  EXPECT_DOUBLE_EQ(clock.wall_s(at(5000)), 2.0);
  clock.begin(0.0, at(1000));
  EXPECT_TRUE(clock.runs());
  EXPECT_DOUBLE_EQ(clock.wall_s(at(1500)), 2.5);
  clock.stop(at(2000));
  clock.stop(at(9000));
  EXPECT_DOUBLE_EQ(clock.wall_s(at(9000)), 3.0);
  clock.begin(0.0, at(10'000));
  EXPECT_DOUBLE_EQ(clock.wall_s(at(10'250)), 3.25);
}

TEST(RunClock, LeavesOutWhatAPreviewTook) {
  RunClock clock(0.0);
  clock.begin(1.0, at(0));
  clock.leave_out(std::chrono::milliseconds(400));
  EXPECT_DOUBLE_EQ(clock.wall_s(at(1000)), 0.6);
  EXPECT_EQ(clock.due_time(1.5), at(900)) << "the pace begins after it, too";
}

TEST(RunClock, ThePaceBeginsAnewWithEveryStretch) {
  RunClock clock(0.0);
  clock.begin(0.0, at(0));
  EXPECT_EQ(clock.due_time(0.25), at(250));
  clock.stop(at(100));
  clock.begin(7.0, at(5000));
  EXPECT_EQ(clock.due_time(7.0), at(5000));
  EXPECT_EQ(clock.due_time(7.5), at(5500));
}

TEST(RunClock, StandsAfterItWasSetBack) {
  RunClock clock(0.0);
  clock.begin(0.0, at(0));
  clock.set_back(0.125);
  EXPECT_FALSE(clock.runs());
  EXPECT_DOUBLE_EQ(clock.wall_s(at(8000)), 0.125);
}

}  // namespace
}  // namespace lipofill::server
