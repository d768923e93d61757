#include "server/sessions/frame_pace.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

FramePace::Clock::time_point at(int ms) {
  return FramePace::Clock::time_point(std::chrono::milliseconds(ms));
}

TEST(FramePace, IsDueOnceAnIntervalOfSimulatedTime) {
  FramePace pace(0.1, 0.0, false);
  EXPECT_TRUE(pace.is_due(0.0, false, at(0)));
  pace.note_offered(0.0);
  EXPECT_FALSE(pace.is_due(0.09, false, at(0)));
  double sum = 0.0;
  for (int k = 0; k < 10; ++k) sum += 0.01;
  ASSERT_LT(sum, 0.1) << "a rounding early";
  EXPECT_TRUE(pace.is_due(sum, false, at(0)));
  pace.note_offered(0.37);
  EXPECT_FALSE(pace.is_due(0.39, false, at(0)));
  EXPECT_TRUE(pace.is_due(0.4, false, at(0))) << "on the grid of the interval, not after the last frame";
  pace.rewind();
  EXPECT_TRUE(pace.is_due(0.05, false, at(0)));
}

TEST(FramePace, ARateCountsFromTheFrameThatWasTaken) {
  FramePace pace(0.0, 100.0, false);
  pace.note_taken(at(3));
  EXPECT_FALSE(pace.is_due(1.0, false, at(12)));
  EXPECT_TRUE(pace.is_due(1.0, false, at(13)));
  EXPECT_TRUE(pace.is_due(1.0, true, at(4))) << "at rest no later frame may come";
}

TEST(FramePace, ASharedRateIsDueAtTheSameMomentsForAll) {
  FramePace one(0.0, 100.0, true);
  FramePace other(0.0, 100.0, true);
  one.note_taken(at(3));
  other.note_taken(at(9));
  for (FramePace* pace : {&one, &other}) {
    EXPECT_FALSE(pace->is_due(1.0, false, at(9)));
    EXPECT_TRUE(pace->is_due(1.0, false, at(10)));
  }
  one.set_max_rate(50.0);
  one.note_taken(at(25));
  EXPECT_FALSE(one.is_due(1.0, false, at(39)));
  EXPECT_TRUE(one.is_due(1.0, false, at(40)));
}

}  // namespace
}  // namespace lipofill::server
