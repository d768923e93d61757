#include "server/ops/self_check.h"

#include <gtest/gtest.h>

#include "server/ops/file_limit.h"

namespace lipofill::server {
namespace {

TEST(SelfCheck, TellsOfEachChangeOnce) {
  std::atomic<bool> reached = true;
  std::atomic<int> checks = 0;
  std::mutex mutex;
  std::condition_variable told;
  std::vector<bool> changes;
  const SelfCheck self_check(
      std::chrono::milliseconds(1),
      [&] {
        ++checks;
        return reached ? absl::OkStatus() : absl::UnavailableError("gone");
      },
      [&](bool good) {
        const std::lock_guard lock(mutex);
        changes.push_back(good);
        told.notify_all();
      });
  const auto await = [&](size_t n) {
    std::unique_lock lock(mutex);
    return told.wait_for(lock, std::chrono::seconds(10), [&] { return changes.size() == n; });
  };
  while (checks < 3) std::this_thread::yield();
  EXPECT_TRUE(self_check.is_good());
  reached = false;
  ASSERT_TRUE(await(1));
  EXPECT_FALSE(self_check.is_good());
  const int then = checks;
  while (checks < then + 3) std::this_thread::yield();
  reached = true;
  ASSERT_TRUE(await(2));
  EXPECT_EQ(changes, (std::vector<bool>{false, true}));
}

TEST(FileLimit, LeavesFilesForTheStore) {
  EXPECT_EQ(connections_within(1024), 256u);
  EXPECT_EQ(connections_within(65'536), 21'760u);
  EXPECT_EQ(connections_within(64), 16u);
  EXPECT_GE(raise_file_limit(), 64u);
}

}  // namespace
}  // namespace lipofill::server
