#include "server/sessions/checkpoint_schedule.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

CheckpointSchedule::Time at(int ms) {
  return CheckpointSchedule::Time(std::chrono::milliseconds(ms));
}

TEST(CheckpointSchedule, IsDueAnIntervalAfterItBegan) {
  CheckpointSchedule schedule(0.5, std::nullopt);
  EXPECT_FALSE(schedule.is_due(at(10'000))) << "it has not begun";
  schedule.begin(at(1000));
  schedule.begin(at(1400));  // it began before
  EXPECT_FALSE(schedule.is_due(at(1499)));
  EXPECT_TRUE(schedule.is_due(at(1500)));
  schedule.begin_next(at(1500), at(1501));
  EXPECT_FALSE(schedule.is_due(at(2000)));
  EXPECT_TRUE(schedule.is_due(at(2001)));
}

TEST(CheckpointSchedule, SlowCheckpointsAreAsFarApartAsAHundredOfThem) {
  CheckpointSchedule schedule(0.5, std::nullopt);
  schedule.begin(at(0));
  schedule.begin_next(at(500), at(520));
  EXPECT_FALSE(schedule.is_due(at(520 + 1999)));
  EXPECT_TRUE(schedule.is_due(at(520 + 2000)));
}

TEST(CheckpointSchedule, IsDueSoonAfterAStartOfTheDaemonAndThenLessOften) {
  CheckpointSchedule schedule(10.0, 7);
  schedule.begin_soon(at(0));
  int now = 0;
  for (const int interval : {250, 500, 1000, 2000, 4000, 8000, 10'000, 10'000}) {
    EXPECT_FALSE(schedule.is_due(at(now + interval - 1))) << now;
    now += interval;
    EXPECT_TRUE(schedule.is_due(at(now))) << now;
    schedule.begin_next(at(now), at(now));
  }
}

TEST(CheckpointSchedule, TakesUpToATenthOfTheRunSoonAfterAStart) {
  CheckpointSchedule schedule(10.0, 7);
  schedule.begin_soon(at(0));
  schedule.begin_next(at(250), at(350));
  EXPECT_FALSE(schedule.is_due(at(350 + 999)));
  EXPECT_TRUE(schedule.is_due(at(350 + 1000)));
}

TEST(CheckpointSchedule, AShortIntervalStaysAsItIs) {
  CheckpointSchedule schedule(0.1, 7);
  schedule.begin_soon(at(0));
  EXPECT_TRUE(schedule.is_due(at(100)));
  schedule.begin_next(at(100), at(101));
  EXPECT_FALSE(schedule.is_due(at(200)));
  EXPECT_TRUE(schedule.is_due(at(201)));
}

TEST(CheckpointSchedule, IsNeverDueWithoutAnInterval) {
  CheckpointSchedule schedule(0.0, 7);
  EXPECT_FALSE(schedule.is_on());
  schedule.begin(at(0));
  EXPECT_FALSE(schedule.is_due(at(1'000'000)));
  EXPECT_EQ(schedule.kept_step(), 7u);
  schedule.note_kept(9);
  EXPECT_EQ(schedule.kept_step(), 9u);
}

}  // namespace
}  // namespace lipofill::server
