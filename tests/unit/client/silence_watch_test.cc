#include "client/cpp/silence_watch.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>

namespace lipofill::client {
namespace {

TEST(SilenceWatch, NoticesAWaitThatLasts) {
  std::promise<void> noticed;
  SilenceWatch silence(std::chrono::milliseconds(20), [&noticed] { noticed.set_value(); });
  silence.begin_wait();
  noticed.get_future().wait();
  EXPECT_TRUE(silence.was_silent());
}

TEST(SilenceWatch, WorkBetweenWaitsIsNoSilence) {
  std::atomic<int> calls = 0;
  {
    SilenceWatch silence(std::chrono::milliseconds(5), [&calls] { ++calls; });
    silence.begin_wait();
    silence.end_wait();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_FALSE(silence.was_silent());
  }
  EXPECT_EQ(calls, 0);
}

TEST(SilenceWatch, EndsAtOnceWhileItWaits) {
  SilenceWatch silence(std::chrono::hours(1), [] { FAIL(); });
  silence.begin_wait();
}

}  // namespace
}  // namespace lipofill::client
