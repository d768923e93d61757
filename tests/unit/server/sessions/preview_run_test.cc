#include "server/sessions/preview_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/sessions/soft_simulation.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

constexpr uint64_t kEpoch = 7;

void finish(PreviewRun& preview, const simulation::Simulation& full) {
  for (int steps = 0; preview.is_due() && steps < 600; ++steps) preview.advance(full, kEpoch);
}

TEST(PreviewRun, IsNothingWhereNoneIsAskedFor) {
  PreviewRun preview(false);
  EXPECT_FALSE(preview.is_due());
  preview.note_changed_plan("an injection was added");
  preview.judge(*make_soft_simulation(), true);
  EXPECT_FALSE(preview.view().has_value());
}

TEST(PreviewRun, ShowsTheSettledShapeOfACoarseModel) {
  const auto full = make_soft_simulation();
  PreviewRun preview(true);
  EXPECT_EQ(preview.view()->state, PreviewState::kPending);
  EXPECT_GT(preview.advance(*full, kEpoch).count(), 0);
  EXPECT_EQ(preview.view()->state, PreviewState::kRunning);
  EXPECT_EQ(preview.view()->n_hexahedra, 64);
  EXPECT_EQ(preview.frame(), nullptr);
  finish(preview, *full);
  EXPECT_EQ(preview.view()->state, PreviewState::kDone) << preview.view()->reason;
  ASSERT_NE(preview.frame(), nullptr);
  EXPECT_TRUE(preview.frame()->preview);
  EXPECT_EQ(preview.frame()->epoch, kEpoch);
  EXPECT_EQ(preview.frame()->sequence, 0u) << "it is shown before the first step";
  EXPECT_EQ(preview.frame()->time_s, preview.view()->report.time);
  preview.judge(*full, true);
  ASSERT_TRUE(preview.view()->difference.has_value());
  EXPECT_NEAR(preview.view()->difference->max, preview.view()->report.skin_max_displacement, 1e-4)
      << "the full simulation is still at rest";
  preview.let_go();
  EXPECT_EQ(preview.frame(), nullptr);
  EXPECT_EQ(preview.view()->state, PreviewState::kDone);
}

TEST(PreviewRun, BeginsAnewOrIsOutdatedWhenThePlanChanges) {
  const auto full = make_soft_simulation();
  PreviewRun preview(true);
  preview.advance(*full, kEpoch);
  EXPECT_EQ(preview.view()->state, PreviewState::kRunning);
  preview.note_changed_plan("an injection was added");
  EXPECT_EQ(preview.view()->state, PreviewState::kPending);
  finish(preview, *full);
  preview.note_changed_plan("an injection was added");
  EXPECT_EQ(preview.view()->state, PreviewState::kOutdated);
  EXPECT_EQ(preview.view()->reason, "an injection was added");
  EXPECT_EQ(preview.frame(), nullptr);
  EXPECT_FALSE(preview.is_due());
  preview.judge(*full, true);
  EXPECT_FALSE(preview.view()->difference.has_value()) << "it is of another plan";
}

TEST(PreviewRun, FailsWhereTheSimulationEndsBeforeIt) {
  const auto full = make_soft_simulation();
  PreviewRun preview(true);
  preview.advance(*full, kEpoch);
  preview.judge(*full, false);
  EXPECT_EQ(preview.view()->state, PreviewState::kFailed);
  EXPECT_THAT(preview.view()->reason, HasSubstr("ended before it"));
}

}  // namespace
}  // namespace lipofill::server
