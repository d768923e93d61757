#include "server/sessions/admission_queue.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace lipofill::server {
namespace {

/// Items are texts whose first letter is their group.
class AdmissionQueueTest : public ::testing::Test {
 protected:
  void push(const std::vector<std::string>& items) {
    for (const std::string& item : items) queue_.push(item, item.substr(0, 1));
  }
  size_t position(const std::string& item) const {
    return queue_.position([&](const std::string& other) { return other == item; });
  }
  bool withdraw(const std::string& item) {
    return queue_.withdraw([&](const std::string& other) { return other == item; });
  }
  std::string admit() { return queue_.admit().item; }
  /// Lets everybody in.
  std::string admit_all() {
    std::string order;
    while (!queue_.empty()) order += admit() + " ";
    return order;
  }

  AdmissionQueue<std::string> queue_;
};

TEST_F(AdmissionQueueTest, OneGroupIsServedInTheOrderItCame) {
  push({"a1", "a2", "a3"});
  EXPECT_EQ(position("a3"), 3u);
  EXPECT_TRUE(withdraw("a2"));
  EXPECT_FALSE(withdraw("a2"));
  EXPECT_EQ(position("a2"), 0u);
  EXPECT_EQ(position("a3"), 2u);
  EXPECT_EQ(queue_.size(), 2u);
  EXPECT_EQ(admit_all(), "a1 a3 ");
}

TEST_F(AdmissionQueueTest, TheGroupWithTheFewestInIsNext) {
  push({"a1", "a2", "a3", "a4", "a5", "b1", "c1", "b2"});
  EXPECT_EQ(admit(), "a1");
  EXPECT_EQ(admit_all(), "b1 c1 a2 b2 a3 a4 a5 ");
}

TEST_F(AdmissionQueueTest, GroupsTakeTurnsWhereThereIsRoomForOne) {
  push({"a1", "a2", "a3", "a4", "b1", "b2"});
  std::string order;
  while (!queue_.empty()) {
    const auto admitted = queue_.admit();
    order += admitted.item + " ";
    queue_.leave(admitted.group);
  }
  EXPECT_EQ(order, "a1 b1 a2 b2 a3 a4 ");
}

TEST_F(AdmissionQueueTest, AGroupThatHasGoneIsForgotten) {
  push({"a1", "b1", "b2"});
  EXPECT_EQ(admit(), "a1");
  EXPECT_EQ(admit(), "b1");
  queue_.leave("a");
  queue_.leave("b");
  push({"c1", "a2"});
  EXPECT_EQ(admit_all(), "c1 a2 b2 ");
}

// Also when some have left, and some were withdrawn.
TEST_F(AdmissionQueueTest, PlacesAreTheOrderOfAdmissionAsThingsStand) {
  std::mt19937 random(7);
  const auto below = [&random](size_t n) { return random() % n; };
  std::vector<std::string> in;
  for (size_t round = 0; round < 300; ++round) {
    const std::string group(1, static_cast<char>('a' + below(4)));
    push({group + std::to_string(round)});
    if (below(3) == 0) in.push_back(admit());
    if (!in.empty() && below(4) == 0) {
      std::swap(in[below(in.size())], in.back());
      queue_.leave(in.back().substr(0, 1));
      in.pop_back();
    }
    if (below(5) == 0) withdraw(group + std::to_string(below(round + 1)));
    AdmissionQueue<std::string> later = queue_;
    for (size_t place = 1; !later.empty(); ++place) EXPECT_EQ(position(later.admit().item), place);
  }
}

}  // namespace
}  // namespace lipofill::server
