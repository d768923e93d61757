#include "server/frames/stream_clock.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

using std::chrono::milliseconds;

StreamClock::Time at(int ms) {
  return StreamClock::Time(milliseconds(ms));
}

StreamClock::WallTime wall(int ms) {
  return StreamClock::WallTime(milliseconds(ms));
}

TEST(StreamClock, AHeartbeatIsDueWhereNothingWasSent) {
  StreamClock clock;
  clock.begin(milliseconds(100), at(0));
  EXPECT_FALSE(clock.heartbeat_is_due(at(99)));
  EXPECT_TRUE(clock.heartbeat_is_due(at(100)));
  clock.note_sent(at(50));
  EXPECT_FALSE(clock.heartbeat_is_due(at(149)));
  EXPECT_TRUE(clock.heartbeat_is_due(at(150)));
}

TEST(StreamClock, AsksForOneAlarmAtATime) {
  StreamClock clock;
  clock.begin(milliseconds(100), at(0));
  EXPECT_EQ(clock.set_alarm(at(0)), at(100));
  clock.note_sent(at(50));
  EXPECT_EQ(clock.set_alarm(at(50)), std::nullopt);
  clock.note_woken(at(60));
  EXPECT_EQ(clock.set_alarm(at(60)), std::nullopt) << "woken by something else";
  clock.note_woken(at(100));
  EXPECT_EQ(clock.set_alarm(at(100)), at(150));
}

TEST(StreamClock, EndsWithTheTokenAndIsWokenForThat) {
  StreamClock clock;
  EXPECT_FALSE(clock.is_over(at(1'000'000'000), wall(1'000'000'000))) << "without a token it has no end";
  clock.set_end(at(70), wall(70));
  clock.begin(milliseconds(100), at(0));
  EXPECT_EQ(clock.set_alarm(at(0)), at(70));
  EXPECT_FALSE(clock.is_over(at(69), wall(69)));
  EXPECT_TRUE(clock.is_over(at(70), wall(0))) << "the wall's clock was set back";
}

TEST(StreamClock, EndsWhenTheClockOfTheWallIsSetPastTheEnd) {
  StreamClock clock;
  clock.set_end(at(3'600'000), wall(3'600'000));
  clock.begin(milliseconds(60'000), at(0));
  EXPECT_EQ(clock.set_alarm(at(1000)), at(6000)) << "it looks now and then";
  EXPECT_FALSE(clock.is_over(at(1000), wall(3'599'999)));
  EXPECT_TRUE(clock.is_over(at(1000), wall(3'600'000)));
}

}  // namespace
}  // namespace lipofill::server
