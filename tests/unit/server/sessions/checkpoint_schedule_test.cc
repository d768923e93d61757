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
