#include "server/sessions/courier.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>
#include <latch>

namespace lipofill::server {
namespace {

class Counter : public Courier::Stream {
 public:
  void deliver() override {
    ++delivered;
    if (on_deliver) on_deliver();
  }
  std::atomic<int> delivered = 0;
  std::function<void()> on_deliver;
};

TEST(Courier, DeliversToEachInTurnAndNotToWhoIsGone) {
  Courier courier;
  std::latch started(1);
  std::latch all_are_waiting(1);
  std::promise<void> last_served;
  const auto slow = std::make_shared<Counter>();
  slow->on_deliver = [&] {
    started.count_down();
    all_are_waiting.wait();
  };
  const auto a = std::make_shared<Counter>();
  auto gone = std::make_shared<Counter>();
  std::weak_ptr<Counter> left = gone;
  const auto last = std::make_shared<Counter>();
  last->on_deliver = [&] { last_served.set_value(); };

  courier.wake(slow);
  started.wait();
  // Whoever wakes is not held up by a delivery under way.
  for (int k = 0; k < 3; ++k) courier.wake(a);
  courier.wake(gone);
  gone.reset();
  courier.wake(last);
  EXPECT_TRUE(left.expired());
  all_are_waiting.count_down();
  last_served.get_future().wait();
  EXPECT_EQ(slow->delivered, 1);
  EXPECT_EQ(a->delivered, 3);
}

TEST(Courier, DeliversAtTheTimeThatWasSetLast) {
  using Clock = Courier::Clock;
  Courier courier;
  const Clock::time_point begin = Clock::now();
  std::promise<Clock::time_point> early_served;
  std::promise<Clock::time_point> late_served;
  const auto early = std::make_shared<Counter>();
  early->on_deliver = [&] { early_served.set_value(Clock::now()); };
  const auto late = std::make_shared<Counter>();
  late->on_deliver = [&] { late_served.set_value(Clock::now()); };
  const auto forgotten = std::make_shared<Counter>();
  courier.wake_at(early, begin + std::chrono::hours(1));
  courier.wake_at(late, begin + std::chrono::milliseconds(60));
  courier.wake_at(forgotten, begin + std::chrono::milliseconds(20));
  courier.wake_at(early, begin + std::chrono::milliseconds(30));
  courier.forget(forgotten);
  EXPECT_GE(early_served.get_future().get() - begin, std::chrono::milliseconds(30));
  EXPECT_GE(late_served.get_future().get() - begin, std::chrono::milliseconds(60));
  EXPECT_EQ(early->delivered, 1);
  EXPECT_EQ(forgotten->delivered, 0);
}

TEST(Courier, DeliversWhatIsWokenFromADelivery) {
  Courier courier;
  std::promise<void> done;
  const auto stream = std::make_shared<Counter>();
  stream->on_deliver = [&] {
    if (stream->delivered < 5) courier.wake(stream);
    if (stream->delivered == 5) done.set_value();
  };
  courier.wake(stream);
  done.get_future().wait();
  EXPECT_EQ(stream->delivered, 5);
}

}  // namespace
}  // namespace lipofill::server
