#include "server/sessions/viewer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/sessions/viewer_frames.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;

TEST(Viewer, LatestSkipsAndCounts) {
  int wakes = 0;
  Viewer viewer({}, [&wakes] { ++wakes; });
  EXPECT_TRUE(has_nothing(viewer));
  for (uint64_t i = 1; i <= 4; ++i) viewer.offer(frame(i));
  EXPECT_EQ(wakes, 4);
  const FrameToSend first = take_frame(viewer);
  EXPECT_EQ(first.frame->sequence, 4u);
  EXPECT_EQ(first.skipped, 3u);
  EXPECT_TRUE(has_nothing(viewer));
  viewer.offer(frame(5));
  const FrameToSend second = take_frame(viewer);
  EXPECT_EQ(second.frame->sequence, 5u);
  EXPECT_EQ(second.skipped, 0u);
}

std::shared_ptr<const Frame> preview(uint64_t sequence, double time_s) {
  auto made = std::make_shared<Frame>();
  made->epoch = 5;
  made->sequence = sequence;
  made->time_s = time_s;
  made->preview = true;
  return made;
}

TEST(Viewer, ThePreviewIsNeverSkippedAndDoesNotCountAsTime) {
  ViewerOptions options;
  options.interval_s = 1.0;
  Viewer viewer(options, [] {});
  viewer.offer(frame(0, 0.0));
  viewer.offer(preview(0, 40.0));
  EXPECT_FALSE(viewer.wants(0.5));
  EXPECT_TRUE(viewer.wants(1.0)) << "40 s are those of another model";
  viewer.offer(frame(100, 1.0));
  viewer.offer(frame(200, 2.0));
  EXPECT_TRUE(take_frame(viewer).frame->preview);
  const FrameToSend next = take_frame(viewer);
  EXPECT_EQ(next.frame->sequence, 200u);
  EXPECT_TRUE(has_nothing(viewer));
}

TEST(Viewer, ThePreviewIsNotShownAgainToWhoSawAStepAfterIt) {
  ViewerOptions options;
  options.seen_epoch = 5;
  options.seen_sequence = 0;
  Viewer first(options, [] {});
  first.offer(preview(0, 40.0));
  EXPECT_TRUE(take_frame(first).frame->preview) << "seeing the start is not seeing the preview";
  options.seen_sequence = 3;
  Viewer later(options, [] {});
  later.offer(preview(0, 40.0));
  EXPECT_TRUE(has_nothing(later));
}

TEST(Viewer, EveryKeepsAllInOrder) {
  ViewerOptions options;
  options.delivery = Delivery::kEvery;
  Viewer viewer(options, [] {});
  for (uint64_t i = 1; i <= 3; ++i) viewer.offer(frame(i));
  for (uint64_t i = 1; i <= 3; ++i) EXPECT_EQ(take_frame(viewer).frame->sequence, i);
  EXPECT_TRUE(has_nothing(viewer));
}

TEST(Viewer, EveryEndsWhenItsBytesOverflow) {
  ViewerOptions options;
  options.delivery = Delivery::kEvery;
  options.max_queued_bytes = 100;  // two frames of 40 bytes fit
  Viewer viewer(options, [] {});
  viewer.offer(frame(1));
  viewer.offer(frame(2));
  EXPECT_FALSE(viewer.closed());
  viewer.offer(frame(3));
  EXPECT_TRUE(viewer.closed());
  viewer.offer(frame(4));
  const absl::Status end = take_end(viewer);
  EXPECT_TRUE(absl::IsResourceExhausted(end)) << end;
  EXPECT_THAT(std::string(end.message()), ::testing::HasSubstr("100 bytes"));
  EXPECT_TRUE(has_nothing(viewer));
}

TEST(Viewer, OneFrameLargerThanTheBoundStillGoes) {
  ViewerOptions options;
  options.delivery = Delivery::kEvery;
  options.max_queued_bytes = 8;
  Viewer viewer(options, [] {});
  viewer.offer(frame(1));
  EXPECT_EQ(take_frame(viewer).frame->sequence, 1u);
  viewer.offer(frame(2));
  EXPECT_EQ(take_frame(viewer).frame->sequence, 2u);
}

TEST(Viewer, EndsOkAfterTheLastFrame) {
  Viewer viewer({}, [] {});
  viewer.show_topology(std::make_shared<Topology>());
  viewer.offer(frame(1));
  viewer.offer(frame(2, 0.0, true));
  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(viewer.take()));
  const FrameToSend last = take_frame(viewer);
  EXPECT_TRUE(last.frame->end);
  EXPECT_EQ(last.skipped, 1u);
  EXPECT_TRUE(take_end(viewer).ok());
  EXPECT_TRUE(has_nothing(viewer));
}

TEST(Viewer, AnErrorComesBeforeWhatIsQueued) {
  Viewer viewer({}, [] {});
  viewer.show_topology(std::make_shared<Topology>());
  viewer.offer(frame(1));
  viewer.close(absl::UnavailableError("stopping"));
  EXPECT_TRUE(absl::IsUnavailable(take_end(viewer)));
}

TEST(Viewer, ThinsFramesByTheInterval) {
  ViewerOptions options;
  options.delivery = Delivery::kEvery;
  options.interval_s = 0.05;
  Viewer viewer(options, [] {});
  std::vector<uint64_t> shown;
  double time_s = 0.0;  // a sum of steps, as in a simulation
  for (uint64_t step = 0; step <= 20; ++step, time_s += 0.01) {
    if (!viewer.wants(time_s)) continue;
    viewer.offer(frame(step, time_s));
    shown.push_back(step);
  }
  EXPECT_THAT(shown, ElementsAre(0, 5, 10, 15, 20));
}

TEST(Viewer, DoesNotSendAgainWhatWasSeen) {
  ViewerOptions options;
  options.delivery = Delivery::kEvery;
  options.seen_epoch = 5;
  options.seen_sequence = 2;
  Viewer viewer(options, [] {});
  for (uint64_t i = 1; i <= 3; ++i) viewer.offer(frame(i));
  EXPECT_EQ(take_frame(viewer).frame->sequence, 3u);
  EXPECT_TRUE(has_nothing(viewer));

  options.seen_epoch = 4;  // another life of the daemon
  Viewer other(options, [] {});
  other.offer(frame(1));
  EXPECT_EQ(take_frame(other).frame->sequence, 1u);
}

TEST(Viewer, TellsTheEndEvenOfASeenFrame) {
  ViewerOptions options;
  options.seen_epoch = 5;
  options.seen_sequence = 9;
  Viewer viewer(options, [] {});
  viewer.offer(frame(9, 0.0, true));
  EXPECT_TRUE(take_frame(viewer).frame->end);
  EXPECT_TRUE(take_end(viewer).ok());
}

TEST(Viewer, IsNotShownTheSameStateTwice) {
  Viewer viewer({}, [] {});
  viewer.offer(frame(3));
  EXPECT_EQ(take_frame(viewer).frame->sequence, 3u);
  viewer.offer(frame(3));
  EXPECT_TRUE(has_nothing(viewer));
  viewer.offer(frame(3, 0.0, true));
  EXPECT_TRUE(take_frame(viewer).frame->end) << "that it is the last one is news";
}

TEST(EncodingCacheTest, EncodesOnceForEachSet) {
  EncodingCache cache;
  int made = 0;
  const auto encode = [&made] {
    ++made;
    return EncodedMessages{"hash", {"bytes"}};
  };
  const auto a = cache.get("skin", encode);
  const auto b = cache.get("skin", encode);
  EXPECT_EQ(a, b);
  cache.get("scan", encode);
  EXPECT_EQ(made, 2);
}

}  // namespace
}  // namespace lipofill::server
