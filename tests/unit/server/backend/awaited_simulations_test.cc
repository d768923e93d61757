#include "server/backend/awaited_simulations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Awaited::Clock::time_point at(int s) {
  return Awaited::Clock::time_point(seconds(s));
}

TEST(AwaitedSimulations, EachIsDueAfterTwiceAsLongUpToAMinute) {
  AwaitedSimulations awaited;
  int now = 0;
  for (const int delay : {1, 2, 4, 8, 16, 32, 60, 60}) {
    awaited.note("a", "room", 7, at(now));
    EXPECT_THAT(awaited.due(at(now + delay - 1)), IsEmpty());
    EXPECT_THAT(awaited.due(at(now + delay)), ElementsAre("a"));
    now += delay;
  }
  EXPECT_EQ(awaited.find("a")->attempts, 8u);
  EXPECT_EQ(awaited.find("a")->waiting_for, "room");
  EXPECT_EQ(awaited.find("a")->until_step, 7u);
}

TEST(AwaitedSimulations, TheLongestDueComesFirst) {
  AwaitedSimulations awaited;
  awaited.note("b", "room", 0, at(0));
  awaited.note("a", "room", 0, at(5));
  EXPECT_THAT(awaited.due(at(100)), ElementsAre("b", "a"));
  awaited.forget("b");
  EXPECT_THAT(awaited.due(at(100)), ElementsAre("a"));
  EXPECT_FALSE(awaited.find("b").has_value());
  EXPECT_EQ(awaited.size(), 1u);
}

TEST(AwaitedSimulations, SaysHowLongItIsUntilTheNextAttempt) {
  AwaitedSimulations awaited;
  awaited.note("a", "room", 0, at(10));
  EXPECT_EQ(awaited.find("a")->delay(at(10)).count(), 1.0);
  EXPECT_EQ(awaited.find("a")->delay(at(20)).count(), 0.0);
}

}  // namespace
}  // namespace lipofill::server
