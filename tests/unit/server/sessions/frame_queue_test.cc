#include "server/sessions/frame_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/sessions/viewer_frames.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<const Frame> preview() {
  auto made = std::make_shared<Frame>();
  made->preview = true;
  return made;
}

TEST(FrameQueue, LatestKeepsOneBesideThePreview) {
  FrameQueue queue(Delivery::kLatest, 0);
  ASSERT_TRUE(queue.push(frame(1)).ok());
  ASSERT_TRUE(queue.push(preview()).ok());
  ASSERT_TRUE(queue.push(frame(2)).ok());
  ASSERT_TRUE(queue.push(frame(3)).ok());
  FrameToSend next = queue.pop();
  EXPECT_TRUE(next.frame->preview);
  EXPECT_EQ(next.skipped, 2u);
  next = queue.pop();
  EXPECT_EQ(next.frame->sequence, 3u);
  EXPECT_EQ(next.skipped, 0u) << "those were told with the preview";
  EXPECT_TRUE(queue.empty());
}

TEST(FrameQueue, EveryKeepsAllUpToTheBound) {
  FrameQueue queue(Delivery::kEvery, 80);  // two frames of 40 bytes
  ASSERT_TRUE(queue.push(frame(1)).ok());
  ASSERT_TRUE(queue.push(frame(2)).ok());
  EXPECT_EQ(queue.pop().frame->sequence, 1u);
  ASSERT_TRUE(queue.push(frame(3)).ok()) << "what was taken counts no more";
  EXPECT_EQ(queue.front().sequence, 2u);
  const absl::Status overflow = queue.push(frame(4));
  EXPECT_TRUE(absl::IsResourceExhausted(overflow));
  EXPECT_THAT(overflow.ToString(), HasSubstr("2 frames (80 bytes) waiting, the bound is 80 bytes"));
  EXPECT_TRUE(queue.empty());
}

TEST(FrameQueue, EveryKeepsUpWhereAllViewersTogetherHaveTooMuch) {
  const uint64_t before = shown_bytes();
  FrameQueue queue(Delivery::kEvery, 1000, before + 100);
  ASSERT_TRUE(queue.push(frame(1)).ok());
  ASSERT_TRUE(queue.push(frame(2)).ok());
  EXPECT_EQ(shown_bytes(), before + 80);
  const ShownBytes of_others(60);
  EXPECT_TRUE(absl::IsResourceExhausted(queue.push(frame(3))));
  EXPECT_EQ(shown_bytes(), before + 60) << "nothing waits any more";
  EXPECT_TRUE(queue.push(frame(4)).ok()) << "one that reads is not behind";
  queue.pop();
  EXPECT_TRUE(queue.push(frame(5)).ok());
}

TEST(FrameQueue, AClearedQueueHasRoomAgain) {
  FrameQueue queue(Delivery::kEvery, 40);
  ASSERT_TRUE(queue.push(frame(1)).ok());
  queue.clear();
  ASSERT_TRUE(queue.push(frame(2)).ok());
  EXPECT_FALSE(queue.push(frame(3)).ok());
}

}  // namespace
}  // namespace lipofill::server
