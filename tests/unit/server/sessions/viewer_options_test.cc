// What a viewer asks for: meshes, fields, a rate, acknowledgement.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/base/field_violations.h"
#include "tests/unit/server/sessions/viewer_frames.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ViewerOptions, ShowsSkinAndFilmsUnlessAsked) {
  Topology topology;
  for (const char* name : {"skin", "scan", "film/deep", "tissue"}) topology.meshes.push_back({name, {}, {}, 3});
  Viewer viewer({}, [] {});
  ASSERT_TRUE(viewer.choose_meshes(topology).ok());
  EXPECT_THAT(viewer.selection().meshes, ElementsAre("film/deep", "skin"));

  ViewerOptions options;
  options.selection.meshes = {"tissue", "bone"};
  Viewer picky(options, [] {});
  const absl::Status refused = picky.choose_meshes(topology);
  ASSERT_EQ(field_violations_of(refused).size(), 1u) << refused;
  EXPECT_EQ(field_violations_of(refused)[0].field, "meshes[1]");
}

TEST(ViewerOptions, FieldsBringTheirMeshesAndAreChecked) {
  Topology topology;
  for (const char* name : {"skin", "film/a.b", "tissue"}) topology.meshes.push_back({name, {}, {}, 3});
  const std::vector<std::string> known = {"skin.pressure", "skin.displacement", "film/a.b.wet"};
  ViewerOptions options;
  options.selection.fields = {"skin.pressure", "film/a.b.wet", "skin.pressure"};
  Viewer viewer(options, [] {});
  ASSERT_TRUE(viewer.choose_meshes(topology).ok());
  EXPECT_TRUE(viewer.check_fields(known).ok());
  EXPECT_THAT(viewer.selection().meshes, ElementsAre("film/a.b", "skin"));
  EXPECT_THAT(viewer.selection().fields, ElementsAre("film/a.b.wet", "skin.pressure"));

  options.selection.meshes = {"skin"};
  Viewer elsewhere(options, [] {});
  ASSERT_TRUE(elsewhere.choose_meshes(topology).ok());
  const absl::Status not_among = elsewhere.check_fields(known);
  ASSERT_EQ(field_violations_of(not_among).size(), 1u) << not_among;
  EXPECT_EQ(field_violations_of(not_among)[0].field, "fields[1]");

  options.selection.fields = {"skin.colour"};
  Viewer unknown(options, [] {});
  ASSERT_TRUE(unknown.choose_meshes(topology).ok());
  EXPECT_THAT(std::string(unknown.check_fields(known).message()), HasSubstr("there are skin.pressure, "));
}

TEST(ViewerOptions, KeepsToTheRateByTheClockUntilAllRests) {
  ViewerOptions options;
  options.max_rate_hz = 10.0;
  Viewer viewer(options, [] {});
  const Viewer::Clock::time_point start{std::chrono::seconds(1000)};
  const auto at = [start](int ms) { return start + std::chrono::milliseconds(ms); };
  EXPECT_TRUE(viewer.wants(0.0, false, at(0)));
  viewer.offer(frame(0));
  EXPECT_TRUE(viewer.wants(0.0, false, at(50))) << "while one waits a newer one takes its place";
  viewer.offer(frame(1));
  const ToSend first = viewer.take(at(60));
  EXPECT_EQ(std::get<FrameToSend>(first).frame->sequence, 1u);
  EXPECT_FALSE(viewer.wants(0.0, false, at(159)));
  EXPECT_TRUE(viewer.wants(0.0, true, at(100))) << "no later frame may come";
  EXPECT_TRUE(viewer.wants(0.0, false, at(161)));
}

TEST(ViewerOptions, SendsTheNewestOnceWhatIsOnItsWayIsAcknowledged) {
  ViewerOptions options;
  options.max_unacknowledged = 2;
  int woken = 0;
  Viewer viewer(options, [&woken] { ++woken; });
  for (uint64_t k = 1; k <= 2; ++k) {
    viewer.offer(frame(k));
    EXPECT_EQ(take_frame(viewer).frame->sequence, k);
  }
  for (uint64_t k = 3; k <= 9; ++k) viewer.offer(frame(k));
  EXPECT_TRUE(has_nothing(viewer));
  EXPECT_EQ(viewer.unacknowledged(), 2u);
  woken = 0;
  ASSERT_TRUE(viewer.acknowledge(5, 1).ok());
  EXPECT_EQ(woken, 1);
  const FrameToSend newest = take_frame(viewer);
  EXPECT_EQ(newest.frame->sequence, 9u);
  EXPECT_EQ(newest.skipped, 6u);
  viewer.offer(frame(10));
  EXPECT_TRUE(has_nothing(viewer));
  ASSERT_TRUE(viewer.acknowledge(5, 9).ok()) << "of both at once";
  EXPECT_EQ(viewer.unacknowledged(), 0u);
  EXPECT_EQ(take_frame(viewer).frame->sequence, 10u);
}

/// A session and a client in one, who keep account of what they did.
struct BothEnds {
  explicit BothEnds(const ViewerOptions& options) : viewer(options, [] {}) {}

  void offer(bool end) { viewer.offer(frame(++offered, 0.0, end)); }
  bool take() {
    const ToSend next = viewer.take();
    const auto* sent = std::get_if<FrameToSend>(&next);
    if (sent == nullptr) return false;
    EXPECT_GT(sent->frame->sequence, taken);
    taken = sent->frame->sequence;
    counted += 1 + sent->skipped;
    return true;
  }
  void acknowledge(uint64_t sequence) {
    if (taken == 0) return;
    EXPECT_TRUE(viewer.acknowledge(5, sequence).ok());
  }

  Viewer viewer;
  uint64_t offered = 0;
  uint64_t taken = 0;
  uint64_t counted = 0;  ///< taken, or told as skipped
};

TEST(ViewerOptions, WhateverTheOrderEachFrameIsTakenOrCounted) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    ViewerOptions options;
    options.delivery = seed % 3 == 0 ? Delivery::kEvery : Delivery::kLatest;
    options.max_unacknowledged = seed % 4;
    BothEnds ends(options);
    for (int k = 0; k < 100; ++k) {
      const unsigned act = random() % 4;
      if (act < 2) ends.offer(false);
      if (act == 2) ends.take();
      if (act == 3) ends.acknowledge(1 + random() % std::max<uint64_t>(ends.taken, 1));
      EXPECT_LE(ends.viewer.unacknowledged(), options.max_unacknowledged);
    }
    ends.offer(true);
    do {
      ends.acknowledge(ends.taken);
    } while (ends.take());
    EXPECT_EQ(ends.taken, ends.offered);
    EXPECT_EQ(ends.counted, ends.offered);
  }
}

TEST(ViewerOptions, TheLastFrameWaitsForNoAcknowledgement) {
  ViewerOptions options;
  options.max_unacknowledged = 1;
  Viewer viewer(options, [] {});
  viewer.offer(frame(1));
  EXPECT_EQ(take_frame(viewer).frame->sequence, 1u);
  viewer.offer(frame(2));
  viewer.offer(frame(3, 0.0, true));
  EXPECT_TRUE(take_frame(viewer).frame->end);
  EXPECT_TRUE(take_end(viewer).ok());
}

TEST(ViewerOptions, RefusesToTakeWhatWasNotSentAsTaken) {
  ViewerOptions options;
  options.max_unacknowledged = 1;
  Viewer viewer(options, [] {});
  viewer.offer(frame(4));
  take_frame(viewer);
  viewer.offer(frame(5));
  EXPECT_EQ(field_violations_of(viewer.acknowledge(5, 5)).at(0).field, "sequence");
  EXPECT_EQ(field_violations_of(viewer.acknowledge(6, 4)).at(0).field, "epoch");
  EXPECT_TRUE(has_nothing(viewer));
}

}  // namespace
}  // namespace lipofill::server
