// A session that shows a preview first.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/sessions/session_fixture.h"
#include "tests/unit/server/sessions/soft_simulation.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

class PreviewTest : public SessionTest {
 protected:
  std::shared_ptr<Session> session(const std::string& id, bool preview) {
    SessionOptions chosen = options(id);
    chosen.preview = preview;
    return std::make_shared<Session>(chosen, make_soft_simulation(), workers_, sink_);
  }
};

TEST_F(PreviewTest, ShowsThePreviewFirstAndSaysHowFarItWas) {
  const auto plain = session("plain", false);
  const auto s = session("a", true);
  EXPECT_FALSE(plain->cached_view().preview.has_value());
  EXPECT_EQ(s->cached_view().preview->state, PreviewState::kPending);
  ViewerOptions every;
  every.delivery = Delivery::kEvery;
  const auto viewer = std::make_shared<Viewer>(every, [] {});
  s->watch(viewer);
  ASSERT_TRUE(start(*s).ok());
  ASSERT_TRUE(start(*plain).ok());
  await_end(*s);
  await_end(*plain);
  EXPECT_EQ(inspect(*s)->state_hash, inspect(*plain)->state_hash);

  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(viewer->take()));
  EXPECT_FALSE(std::get<FrameToSend>(viewer->take()).frame->preview) << "the start";
  const auto shown = std::get<FrameToSend>(viewer->take()).frame;
  EXPECT_TRUE(shown->preview);
  EXPECT_EQ(shown->sequence, 0u);
  EXPECT_EQ(shown->fields[0].values.size(), 3u * 17 * 17) << "on the full skin";
  EXPECT_EQ(std::get<FrameToSend>(viewer->take()).frame->sequence, 1u);

  const PreviewView preview = *sink_.views.at("a").preview;
  EXPECT_EQ(preview.state, PreviewState::kDone) << preview.reason;
  EXPECT_EQ(preview.n_hexahedra, 64);
  EXPECT_GT(preview.wall_s, 0.0);
  EXPECT_LT(preview.report.step, inspect(*s)->report.step);
  ASSERT_TRUE(preview.difference.has_value());
  EXPECT_GT(preview.difference->max, 0.0);
  EXPECT_LT(preview.difference->max, inspect(*s)->report.skin_max_displacement);
}

TEST_F(PreviewTest, GoesOnWithoutAPreviewThatCannotBe) {
  // A zone between the centres of the coarse film's cells.
  SessionOptions chosen = options("a");
  chosen.preview = true;
  auto simulation = make_soft_simulation();
  plan::SimulationSpec spec = simulation->spec();
  spec.films[0].zones = {{"all", geometry::ChartBox{0.28, 0.34, 0.2, 0.8}}};
  spec.injections[0].volume = 2e-8;
  auto narrow = simulation::Simulation::create(simulation->shared_model(), spec);
  ASSERT_TRUE(narrow.ok()) << narrow.status();
  const auto s = std::make_shared<Session>(chosen, *std::move(narrow), workers_, sink_);
  ASSERT_TRUE(start(*s).ok());
  await_end(*s);
  const auto view = inspect(*s);
  EXPECT_EQ(view->state, SimulationState::kSettled) << view->reason;
  EXPECT_EQ(view->preview->state, PreviewState::kFailed);
  EXPECT_THAT(view->preview->reason, HasSubstr("the coarse model cannot hold the plan"));
  EXPECT_FALSE(view->preview->difference.has_value());
}

TEST_F(PreviewTest, AnInjectionAfterThePreviewMakesItOutdated) {
  const auto s = session("a", true);
  ASSERT_TRUE(start(*s).ok());
  while (s->cached_view().report.step < 3) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto injected = ask([&](auto reply) {
    s->inject({{"all", 0.5e-7, 1e-6, std::nullopt, std::nullopt}, ""}, {}, reply);
  });
  ASSERT_TRUE(injected.ok()) << injected.status();
  EXPECT_EQ(injected->preview->state, PreviewState::kOutdated);
  const auto late = std::make_shared<Viewer>(ViewerOptions(), [] {});
  s->watch(late);
  ASSERT_TRUE(inspect(*s).ok()) << "commands are carried out in order";
  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(late->take()));
  EXPECT_FALSE(std::get<FrameToSend>(late->take()).frame->preview);
  await_end(*s);
  EXPECT_EQ(inspect(*s)->preview->state, PreviewState::kOutdated);
  EXPECT_FALSE(inspect(*s)->preview->difference.has_value());
}

TEST_F(PreviewTest, StopsWithinAStepOfThePreview) {
  const auto s = session("a", true);
  ASSERT_TRUE(start(*s).ok());
  const auto paused = pause(*s);
  ASSERT_TRUE(paused.ok());
  const auto stopped = ask([&](auto reply) { s->stop("enough", {}, reply); });
  ASSERT_TRUE(stopped.ok());
  if (stopped->report.step == 0) {
    EXPECT_EQ(stopped->preview->state, PreviewState::kFailed);
    EXPECT_EQ(stopped->preview->reason, "the simulation ended before it");
  }
  EXPECT_FALSE(stopped->preview->difference.has_value());
}

}  // namespace
}  // namespace lipofill::server
