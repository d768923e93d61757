#include "server/sessions/mailbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <latch>
#include <thread>
#include <vector>

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;

TEST(Mailbox, CarriesOutAtOnceWhenNobodyActs) {
  Mailbox mailbox;
  int done = 0;
  mailbox.post([&] { ++done; });
  EXPECT_EQ(done, 1);
  EXPECT_TRUE(mailbox.empty());
}

TEST(Mailbox, WhoActsCarriesOutWhatOthersPost) {
  Mailbox mailbox;
  std::vector<int> order;
  std::thread::id by;
  std::latch acting(1);
  std::latch posted(1);
  std::thread actor([&] {
    mailbox.act([&] {
      acting.count_down();
      posted.wait();
      order.push_back(1);
    });
  });
  const std::thread::id actors_id = actor.get_id();
  acting.wait();
  mailbox.post([&] {
    order.push_back(2);
    by = std::this_thread::get_id();
  });
  EXPECT_FALSE(mailbox.empty()) << "the caller did not wait for it";
  posted.count_down();
  actor.join();
  EXPECT_THAT(order, ElementsAre(1, 2));
  EXPECT_EQ(by, actors_id);
}

TEST(Mailbox, CarriesOutInOrderBetweenTwoThingsToDo) {
  Mailbox mailbox;
  std::vector<int> order;
  mailbox.act([&] {
    mailbox.queue([&] { order.push_back(1); });
    mailbox.queue([&] {
      order.push_back(2);
      mailbox.queue([&] { order.push_back(3); });
    });
    mailbox.carry_out();
    order.push_back(4);
    mailbox.queue([&] { order.push_back(5); });
  });
  EXPECT_THAT(order, ElementsAre(1, 2, 3, 4, 5));
}

TEST(Mailbox, DeferredCommandsComeBehindThoseThatWaitOrAtOnce) {
  Mailbox mailbox;
  std::vector<int> order;
  mailbox.act([&] {
    mailbox.defer([&] { order.push_back(2); });
    mailbox.queue([&] { order.push_back(1); });
    mailbox.queue_deferred();
    mailbox.carry_out();
    mailbox.defer([&] { order.push_back(3); });
    mailbox.queue([&] { order.push_back(4); });
    mailbox.carry_out_deferred();
    mailbox.queue_deferred();  // there is none left
  });
  EXPECT_THAT(order, ElementsAre(1, 2, 3, 4));
}

TEST(Mailbox, NothingIsLostAndNothingRunsTwiceAmongManyThreads) {
  constexpr int kThreads = 4;
  constexpr int kEach = 500;
  Mailbox mailbox;
  int done = 0;  // no atomic: one thread acts at a time
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kEach; ++i) {
        if (t == 0) {
          mailbox.act([&] { ++done; });
        } else {
          mailbox.post([&] { ++done; });
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(done, kThreads * kEach);
  EXPECT_TRUE(mailbox.empty());
}

}  // namespace
}  // namespace lipofill::server
