#include "server/sessions/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "server/sessions/session_manager.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

/// Keeps in memory what a store would.
class MemorySink : public SessionSink {
 public:
  absl::Status append_series(const std::string&, const std::vector<SeriesEntry>& rows) override {
    const std::lock_guard lock(mutex);
    for (const SeriesEntry& row : rows) steps.push_back(row.report.step);
    return absl::OkStatus();
  }
  absl::Status ended(const std::string& id, const SessionView& view, const Topology&, const Frame& frame) override {
    const std::lock_guard lock(mutex);
    views[id] = view;
    EXPECT_TRUE(frame.end);
    return absl::OkStatus();
  }
  std::mutex mutex;
  std::vector<uint64_t> steps;
  std::map<std::string, SessionView> views;
};

/// A film with a wall of its own: steps of microseconds.
std::unique_ptr<simulation::Simulation> make_simulation(double end_s) {
  simulation::FaceModelSpec face;
  face.region = geometry::SquareSpec{0.04, 0.04};
  face.n_xi = face.n_eta = 4;
  const auto model = simulation::build_face_model(face, [](double, const char*) { return true; });
  EXPECT_TRUE(model.ok()) << model.status();
  simulation::SimulationSpec spec;
  simulation::FilmSpec film;
  film.name = "plane";
  film.n_xi = film.n_eta = 3;
  film.zones = {{"all", simulation::ChartBox{}}};
  film.wall = simulation::FilmWallKind::kWinkler;
  film.wall_stiffness = 1e7;
  spec.films = {film};
  spec.injections = {{"all", 1e-7, 1e-6, 0.0, std::nullopt}};
  spec.settle_skin_speed = 0.0;
  spec.end = end_s;
  auto made = simulation::Simulation::create(*model, spec);
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

/// Skin over a film, injected for a tenth of a second and at rest some seconds later.
std::unique_ptr<simulation::Simulation> make_soft_simulation() {
  simulation::FaceModelSpec face;
  face.region = geometry::SquareSpec{0.04, 0.04};
  face.n_xi = face.n_eta = 16;
  face.layers = {{"skin", {geometry::ScalarField::constant(3e-3), 1}, {6e4, 0.45, 1100.0}}};
  const auto model = simulation::build_face_model(face, [](double, const char*) { return true; });
  EXPECT_TRUE(model.ok()) << model.status();
  simulation::SimulationSpec spec;
  simulation::FilmSpec film;
  film.name = "plane";
  film.below_layer = "skin";
  film.n_xi = film.n_eta = 8;
  film.rest_thickness = geometry::ScalarField::constant(0.5e-3);
  film.zones = {{"all", simulation::ChartBox{0.2, 0.8, 0.2, 0.8}}};
  spec.films = {film};
  spec.injections = {{"all", 1e-7, 1e-6, 0.0, std::nullopt}};
  spec.settle_skin_speed = 0.05e-3;
  spec.max_step = 0.5;
  auto made = simulation::Simulation::create(*model, spec);
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

class SessionTest : public ::testing::Test {
 protected:
  std::shared_ptr<Session> session(const std::string& id, double end_s, bool real_time = false) {
    return std::make_shared<Session>(SessionOptions{id, 7, real_time}, make_simulation(end_s), workers_, sink_);
  }
  std::shared_ptr<Session> soft_session(const std::string& id, bool preview) {
    SessionOptions options{id, 7, false};
    options.preview = preview;
    return std::make_shared<Session>(options, make_soft_simulation(), workers_, sink_);
  }
  /// Gives a command and waits for its answer.
  template <typename Command>
  absl::StatusOr<SessionView> ask(Command&& command) {
    auto answer = std::make_shared<std::promise<absl::StatusOr<SessionView>>>();
    command([answer](absl::StatusOr<SessionView> view) { answer->set_value(std::move(view)); });
    return answer->get_future().get();
  }
  absl::StatusOr<SessionView> start(Session& s) {
    return ask([&s](auto reply) { s.start(reply); });
  }
  absl::StatusOr<SessionView> pause(Session& s) {
    return ask([&s](auto reply) { s.pause(reply); });
  }
  absl::StatusOr<SessionView> inspect(Session& s) {
    return ask([&s](auto reply) { s.inspect(reply); });
  }
  void await_end(const Session& s) {
    while (!has_ended(s.cached_view().state)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  MemorySink sink_;
  WorkerPool workers_{2};
};

TEST_F(SessionTest, RunsToTheEndAndKeepsEveryRow) {
  const auto s = session("a", 12.0);
  ASSERT_TRUE(start(*s).ok());
  await_end(*s);
  const auto view = inspect(*s);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view->state, SimulationState::kFinished) << view->reason;
  EXPECT_EQ(view->report.step, 1200u);
  EXPECT_EQ(view->state_hash.size(), 64u);
  workers_.stop();
  EXPECT_EQ(sink_.steps.size(), 1200u);
  EXPECT_TRUE(std::is_sorted(sink_.steps.begin(), sink_.steps.end()));
  EXPECT_EQ(sink_.views.at("a").state_hash, view->state_hash);
  EXPECT_TRUE(s->pending_series(0).empty());
}

TEST_F(SessionTest, GivesTheSameHashBesideOthersPausedOrNot) {
  std::vector<std::shared_ptr<Session>> all;
  for (int i = 0; i < 6; ++i) all.push_back(session(std::to_string(i), 5.0));
  for (const auto& s : all) ASSERT_TRUE(start(*s).ok());
  if (pause(*all[0]).ok()) {
    ASSERT_TRUE(ask([&](auto reply) { all[0]->resume(reply); }).ok());
  }
  for (const auto& s : all) await_end(*s);
  const std::string hash = inspect(*all[0])->state_hash;
  for (const auto& s : all) EXPECT_EQ(inspect(*s)->state_hash, hash);
}

TEST_F(SessionTest, NamesTheStateThatDoesNotFit) {
  const auto s = session("a", 1e6);
  EXPECT_THAT(pause(*s).status().ToString(), HasSubstr("READY"));
  ASSERT_TRUE(start(*s).ok());
  const auto again = start(*s);
  EXPECT_TRUE(absl::IsFailedPrecondition(again.status()));
  EXPECT_THAT(again.status().ToString(), HasSubstr("RUNNING"));
  const auto paused = pause(*s);
  ASSERT_TRUE(paused.ok());
  EXPECT_EQ(inspect(*s)->report.step, paused->report.step);
  const auto stopped = ask([&](auto reply) { s->stop("enough", reply); });
  ASSERT_TRUE(stopped.ok());
  EXPECT_EQ(stopped->state, SimulationState::kStopped);
  EXPECT_EQ(stopped->reason, "enough");
  EXPECT_THAT(start(*s).status().ToString(), HasSubstr("STOPPED"));
  EXPECT_EQ(inspect(*s)->state_hash, stopped->state_hash);
}

TEST_F(SessionTest, AnswersManyCommandsFromManyThreads) {
  const auto s = session("a", 1e6);
  ASSERT_TRUE(start(*s).ok());
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) EXPECT_TRUE(inspect(*s).ok());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(ask([&](auto reply) { s->stop("", reply); }).ok());
}

TEST_F(SessionTest, ShowsFramesUntilTheEndAndAfterIt) {
  const auto s = session("a", 0.5);
  ViewerOptions options;
  options.delivery = Delivery::kEvery;
  const auto viewer = std::make_shared<Viewer>(options, [] {});
  s->watch(viewer);
  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(viewer->take()));
  ASSERT_TRUE(start(*s).ok());
  await_end(*s);
  ASSERT_TRUE(inspect(*s).ok());
  for (uint64_t step = 0; step <= 50; ++step) {
    const ToSend next = viewer->take();
    const auto* frame = std::get_if<FrameToSend>(&next);
    ASSERT_NE(frame, nullptr) << step;
    EXPECT_EQ(frame->frame->sequence, step);
    EXPECT_EQ(frame->frame->epoch, 7u);
  }
  EXPECT_TRUE(std::holds_alternative<EndOfStream>(viewer->take()));

  const auto late = std::make_shared<Viewer>(ViewerOptions{}, [] {});
  s->watch(late);
  ASSERT_TRUE(inspect(*s).ok()) << "commands are carried out in order";
  EXPECT_TRUE(std::holds_alternative<TopologyToSend>(late->take()));
  EXPECT_TRUE(std::get<FrameToSend>(late->take()).frame->end);
}

TEST_F(SessionTest, ShowsThePreviewFirstAndSaysHowFarItWas) {
  const auto plain = soft_session("plain", false);
  const auto s = soft_session("a", true);
  EXPECT_FALSE(plain->cached_view().preview.has_value());
  EXPECT_EQ(s->cached_view().preview->state, PreviewState::kPending);
  ViewerOptions options;
  options.delivery = Delivery::kEvery;
  const auto viewer = std::make_shared<Viewer>(options, [] {});
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

TEST_F(SessionTest, GoesOnWithoutAPreviewThatCannotBe) {
  // A zone between the centres of the coarse film's cells.
  SessionOptions options{"a", 7, false};
  options.preview = true;
  auto simulation = make_soft_simulation();
  simulation::SimulationSpec spec = simulation->spec();
  spec.films[0].zones = {{"all", simulation::ChartBox{0.28, 0.34, 0.2, 0.8}}};
  spec.injections[0].volume = 2e-8;
  auto narrow = simulation::Simulation::create(simulation->shared_model(), spec);
  ASSERT_TRUE(narrow.ok()) << narrow.status();
  const auto s = std::make_shared<Session>(options, *std::move(narrow), workers_, sink_);
  ASSERT_TRUE(start(*s).ok());
  await_end(*s);
  const auto view = inspect(*s);
  EXPECT_EQ(view->state, SimulationState::kSettled) << view->reason;
  EXPECT_EQ(view->preview->state, PreviewState::kFailed);
  EXPECT_THAT(view->preview->reason, HasSubstr("the coarse model cannot hold the plan"));
  EXPECT_FALSE(view->preview->difference.has_value());
}

TEST_F(SessionTest, AnInjectionAfterThePreviewMakesItOutdated) {
  const auto s = soft_session("a", true);
  ASSERT_TRUE(start(*s).ok());
  while (s->cached_view().report.step < 3) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto injected = ask([&](auto reply) { s->inject({"all", 0.5e-7, 1e-6, std::nullopt, std::nullopt}, reply); });
  ASSERT_TRUE(injected.ok()) << injected.status();
  EXPECT_EQ(injected->preview->state, PreviewState::kOutdated);
  await_end(*s);
  EXPECT_EQ(inspect(*s)->preview->state, PreviewState::kOutdated);
  EXPECT_FALSE(inspect(*s)->preview->difference.has_value());
}

TEST_F(SessionTest, StopsWithinAStepOfThePreview) {
  const auto s = soft_session("a", true);
  ASSERT_TRUE(start(*s).ok());
  const auto paused = pause(*s);
  ASSERT_TRUE(paused.ok());
  const auto stopped = ask([&](auto reply) { s->stop("enough", reply); });
  ASSERT_TRUE(stopped.ok());
  if (stopped->report.step == 0) {
    EXPECT_EQ(stopped->preview->state, PreviewState::kFailed);
    EXPECT_EQ(stopped->preview->reason, "the simulation ended before it");
  }
  EXPECT_FALSE(stopped->preview->difference.has_value());
}

TEST_F(SessionTest, StopsWhileItWaitsForRealTime) {
  const auto s = session("a", 1e6, true);
  ASSERT_TRUE(start(*s).ok());
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  const auto stopped = ask([&](auto reply) { s->stop("", reply); });
  ASSERT_TRUE(stopped.ok());
  EXPECT_LE(stopped->report.time, stopped->wall_s + 0.011);
}

TEST_F(SessionTest, TheManagerBoundsAndStopsAll) {
  SessionManager manager(2);
  for (const char* id : {"a", "b"}) {
    auto place = manager.reserve();
    ASSERT_TRUE(place.ok());
    const auto s = session(id, 1e6);
    ASSERT_TRUE(manager.add(*std::move(place), s));
    ASSERT_TRUE(start(*s).ok());
  }
  const auto refused = manager.reserve();
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status()));
  EXPECT_THAT(refused.status().ToString(), HasSubstr("bound is 2"));
  manager.remove("b");
  EXPECT_TRUE(manager.reserve().ok()) << "given back when it is not used";
  const auto a = manager.find("a");
  const auto viewer = std::make_shared<Viewer>(ViewerOptions{}, [] {});
  a->watch(viewer);
  manager.stop_all("daemon stopped");
  EXPECT_EQ(a->cached_view().state, SimulationState::kStopped);
  EXPECT_EQ(a->cached_view().reason, "daemon stopped");
  EXPECT_TRUE(viewer->closed());
  EXPECT_TRUE(absl::IsUnavailable(manager.reserve().status()));
}

}  // namespace
}  // namespace lipofill::server
