#include "core/base/shared_cache.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace lipofill {
namespace {

using Cache = SharedCache<std::string>;
using Pointer = Cache::Pointer;

auto make(const std::string& text) {
  return [text]() -> absl::StatusOr<Pointer> { return std::make_shared<const std::string>(text); };
}

absl::StatusOr<Pointer> must_not_be_called() {
  ADD_FAILURE() << "made again";
  return nullptr;
}

TEST(SharedCache, SharesWhatIsHeldAndForgetsTheRest) {
  Cache cache;
  Pointer a = *cache.get("a", make("1"));
  const Pointer b = *cache.get("b", make("2"));
  EXPECT_EQ(*cache.get("a", must_not_be_called), a);
  EXPECT_NE(a, b);
  EXPECT_EQ(cache.size(), 2u);
  a.reset();
  EXPECT_EQ(cache.size(), 1u);
  EXPECT_EQ(**cache.get("a", make("3")), "3");
}

TEST(SharedCache, PassesErrorsOnAndKeepsNothingOfThem) {
  Cache cache;
  const auto fail = []() -> absl::StatusOr<Pointer> { return absl::ResourceExhaustedError("full"); };
  EXPECT_EQ(cache.get("a", fail).status(), absl::ResourceExhaustedError("full"));
  EXPECT_EQ(**cache.get("a", make("1")), "1");
}

TEST(SharedCache, GivesOneValueToManyThreads) {
  Cache cache;
  std::vector<Pointer> got(8);
  std::vector<std::thread> threads;
  for (Pointer& one : got) {
    threads.emplace_back([&cache, &one] { one = *cache.get("a", make("1")); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Pointer& one : got) EXPECT_EQ(one, got[0]);
  EXPECT_EQ(cache.size(), 1u);
}

}  // namespace
}  // namespace lipofill
