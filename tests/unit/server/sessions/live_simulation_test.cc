#include "server/sessions/live_simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/sessions/session_fixture.h"
#include "tests/unit/server/sessions/viewer_frames.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;

class LiveSimulationTest : public ::testing::Test {
 protected:
  LiveSimulation make(double end_s = 1.0, double wall_s = 0.0) {
    SessionOptions options;
    options.id = "a";
    options.epoch = 7;
    return LiveSimulation(options, make_simulation(end_s), SimulationState::kReady, wall_s, sink_);
  }
  std::shared_ptr<Viewer> viewer() {
    ViewerOptions every;
    every.delivery = Delivery::kEvery;
    return std::make_shared<Viewer>(every, [] {});
  }

  MemorySink sink_;
};

TEST_F(LiveSimulationTest, AStepChangesFiguresAndSeriesAndIsShown) {
  LiveSimulation live = make();
  const auto watching = viewer();
  live.watch(watching);
  EXPECT_TRUE(live.is_watched());
  live.advance_step();
  EXPECT_EQ(live.figures().copy().report.step, 1u);
  EXPECT_EQ(live.series().after(0).size(), 1u);
  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(watching->take()));
  EXPECT_EQ(take_frame(*watching).frame->sequence, 0u);
  EXPECT_EQ(take_frame(*watching).frame->sequence, 1u);
  EXPECT_EQ(live.measure().state_hash, live.simulation()->state_hash());
}

TEST_F(LiveSimulationTest, GoesBackInANewEpochWithoutTheRowsOfTheFutureItLeft) {
  LiveSimulation live = make();
  const auto watching = viewer();
  live.watch(watching);
  for (int step = 0; step < 3; ++step) live.advance_step();
  live.go_back(make_simulation(1.0), 0.5);
  EXPECT_TRUE(live.series().after(0).empty());
  EXPECT_EQ(live.figures().copy().report.step, 0u);
  EXPECT_EQ(live.figures().copy().wall_s, 0.5);
  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(watching->take()));
  for (uint64_t step = 0; step <= 3; ++step) EXPECT_EQ(take_frame(*watching).frame->epoch, 7u);
  const auto again = take_frame(*watching).frame;
  EXPECT_EQ(again->epoch, sink_.epoch);
  EXPECT_EQ(again->sequence, 0u);
}

TEST_F(LiveSimulationTest, ACheckpointTakesTheRowsThatWaitedWithIt) {
  LiveSimulation live = make(1.0, 2.0);
  for (int step = 0; step < 3; ++step) live.advance_step();
  const auto kept = live.keep_checkpoint(CheckpointKind::kAsked, "c1", 0, {});
  ASSERT_TRUE(kept.ok()) << kept.status();
  EXPECT_EQ(kept->step, 3u);
  EXPECT_EQ(kept->wall_s, 2.0) << "its clock stands";
  EXPECT_EQ(kept->state_hash, live.simulation()->state_hash());
  EXPECT_THAT(sink_.steps, ElementsAre(1, 2, 3));
  EXPECT_TRUE(live.series().after(0).empty());
  sink_.room = absl::ResourceExhaustedError("the disk is full");
  live.advance_step();
  EXPECT_FALSE(live.keep_checkpoint(CheckpointKind::kAsked, "c2", 0, {}).ok());
  EXPECT_EQ(live.series().after(0).size(), 1u) << "the row waits";
}

TEST_F(LiveSimulationTest, ItsLastFrameAndFiguresStayWhenItIsLetGoOf) {
  LiveSimulation live = make(0.02);
  live.advance_step();
  live.advance_step();
  ASSERT_EQ(live.simulation()->phase(), simulation::Phase::kFinished);
  const std::string hash = live.simulation()->state_hash();
  live.set_state(SimulationState::kFinished, "the end came");
  live.conclude();
  live.let_go();
  EXPECT_EQ(live.simulation(), nullptr);
  EXPECT_TRUE(live.result_is_kept());
  EXPECT_EQ(sink_.views.at("a").state_hash, hash);
  EXPECT_EQ(live.measure().state_hash, hash);
  const auto late = viewer();
  live.watch(late);
  EXPECT_FALSE(live.is_watched()) << "nothing more will come";
  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(late->take()));
  EXPECT_TRUE(take_frame(*late).frame->end);
}

TEST_F(LiveSimulationTest, WithoutAResultThereIsNothingToShow) {
  LiveSimulation live = make();
  live.let_go();
  const auto late = viewer();
  live.watch(late);
  EXPECT_TRUE(absl::IsInternal(take_end(*late)));
  bool answered = false;
  live.capture({"skin"}, [&](const std::shared_ptr<const Topology>& meshes, const std::shared_ptr<const Frame>& frame) {
    answered = true;
    EXPECT_EQ(meshes, nullptr);
    EXPECT_EQ(frame, nullptr);
  });
  EXPECT_TRUE(answered);
  EXPECT_TRUE(absl::IsDataLoss(live.keep_result()));
}

}  // namespace
}  // namespace lipofill::server
