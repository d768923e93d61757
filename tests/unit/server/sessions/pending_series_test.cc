#include "server/sessions/pending_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/server/sessions/session_fixture.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;

SeriesEntry row(uint64_t step) {
  SeriesEntry entry;
  entry.report.step = step;
  return entry;
}

std::vector<uint64_t> steps_after(const PendingSeries& series, uint64_t step) {
  std::vector<uint64_t> steps;
  for (const SeriesEntry& entry : series.after(step)) steps.push_back(entry.report.step);
  return steps;
}

TEST(PendingSeries, ShowsRowsUntilTheyAreInTheSink) {
  MemorySink sink;
  PendingSeries series("a", sink);
  for (uint64_t step = 1; step <= 3; ++step) series.add(row(step));
  EXPECT_THAT(steps_after(series, 1), ElementsAre(2, 3));
  EXPECT_TRUE(sink.steps.empty());
  ASSERT_TRUE(series.flush().ok());
  EXPECT_THAT(sink.steps, ElementsAre(1, 2, 3));
  EXPECT_TRUE(series.after(0).empty());
  EXPECT_TRUE(series.flush().ok()) << "with nothing to hand on";
  EXPECT_EQ(sink.steps.size(), 3u);
}

TEST(PendingSeries, HandsOnInChunks) {
  MemorySink sink;
  PendingSeries series("a", sink);
  for (uint64_t step = 1; step < PendingSeries::kChunk; ++step) series.add(row(step));
  EXPECT_TRUE(sink.steps.empty());
  series.add(row(PendingSeries::kChunk));
  EXPECT_EQ(sink.steps.size(), PendingSeries::kChunk);
  EXPECT_TRUE(series.after(0).empty());
}

TEST(PendingSeries, RowsWaitForRoomAndGoOnInOrder) {
  MemorySink sink;
  sink.room = absl::ResourceExhaustedError("the disk is full");
  PendingSeries series("a", sink);
  for (uint64_t step = 1; step <= PendingSeries::kChunk; ++step) series.add(row(step));
  EXPECT_TRUE(absl::IsResourceExhausted(series.flush()));
  EXPECT_EQ(series.after(0).size(), PendingSeries::kChunk);
  sink.room = absl::OkStatus();
  series.add(row(PendingSeries::kChunk + 1));
  ASSERT_TRUE(series.flush().ok());
  EXPECT_EQ(sink.steps.size(), PendingSeries::kChunk + 1);
  EXPECT_TRUE(std::is_sorted(sink.steps.begin(), sink.steps.end()));
}

TEST(PendingSeries, KeepsABoundedNumberOfRows) {
  MemorySink sink;
  sink.room = absl::ResourceExhaustedError("the disk is full");
  PendingSeries series("a", sink);
  for (uint64_t step = 1; step < PendingSeries::kMost; ++step) series.add(row(step));
  EXPECT_EQ(series.after(PendingSeries::kMost - 2).size(), 1u);
  series.add(row(PendingSeries::kMost));
  EXPECT_TRUE(series.after(0).empty()) << "they are lost";
  series.add(row(PendingSeries::kMost + 1));
  EXPECT_THAT(steps_after(series, 0), ElementsAre(PendingSeries::kMost + 1));
}

/// The bound and the end of a chunk fall on the same row: where there is room again by then,
/// nothing is lost.
TEST(PendingSeries, LosesNothingWhenThereIsRoomAtTheLastMoment) {
  MemorySink sink;
  sink.room = absl::ResourceExhaustedError("the disk is full");
  PendingSeries series("a", sink);
  for (uint64_t step = 1; step < PendingSeries::kMost; ++step) series.add(row(step));
  sink.room = absl::OkStatus();
  series.add(row(PendingSeries::kMost));
  EXPECT_EQ(sink.steps.size(), PendingSeries::kMost);
  EXPECT_TRUE(series.after(0).empty());
}

TEST(PendingSeries, ForgetsTheFirstRowsWhenToldTo) {
  MemorySink sink;
  PendingSeries series("a", sink);
  for (uint64_t step = 1; step <= 3; ++step) series.add(row(step));
  series.forget(2);
  EXPECT_THAT(steps_after(series, 0), ElementsAre(3));
}

}  // namespace
}  // namespace lipofill::server
