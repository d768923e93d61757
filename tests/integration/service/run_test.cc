// A small square from model to result: states, figures, series, restarts.

#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using Simulations = v1::SimulationService::Stub;
using ::testing::HasSubstr;

// A shape that is found directly is one step of some seconds.
TEST_F(RunTest, IsLookedAtInTheMiddleOfALongStep) {
  v1::ModelSpec large = square_spec();
  large.set_n_xi(70);
  large.set_n_eta(70);
  v1::Operation operation;
  ASSERT_TRUE(build("patients/anna", large, operation).ok());
  v1::Model model;
  ASSERT_TRUE(operation.response().UnpackTo(&model)) << operation.error().message();
  v1::SimulationSpec plan = square_plan(model.name(), 10.0);
  plan.mutable_time()->set_goal(v1::TimeControl::SETTLED_SHAPE);
  plan.mutable_time()->clear_settle_skin_speed_mm_per_s();
  v1::Simulation simulation;
  ASSERT_TRUE(create_simulation(plan, "x", true, simulation).ok());
  int seen_running = 0;
  while (true) {
    simulation = get_simulation("simulations/x");
    if (simulation.state() != v1::Simulation::RUNNING && simulation.state() != v1::Simulation::QUEUED) break;
    if (simulation.state() == v1::Simulation::RUNNING && simulation.summary().steps() == 0) ++seen_running;
  }
  EXPECT_EQ(simulation.state(), v1::Simulation::SETTLED) << simulation.reason();
  EXPECT_EQ(simulation.summary().steps(), 1u);
  EXPECT_GT(seen_running, 0) << "nobody waits until it is over";
}

TEST_F(RunTest, FinishesWithFiguresAndSeries) {
  create(0.3, "x");
  const v1::Simulation ended = await_end("simulations/x");
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED) << ended.reason();
  const v1::Summary& summary = ended.summary();
  EXPECT_EQ(summary.steps(), 30u);
  EXPECT_NEAR(summary.time_s(), 0.3, 1e-9);
  EXPECT_NEAR(summary.injected_ml(), 0.03, 1e-9);
  EXPECT_LT(summary.film_volume_relative_error(), 1e-10);
  EXPECT_GT(summary.skin_max_displacement_mm(), 0.0);
  EXPECT_GT(summary.max_pressure_pa(), 0.0);
  EXPECT_EQ(summary.hexahedra(), 128u);
  EXPECT_EQ(summary.film_cells(), 9u);
  EXPECT_GT(summary.step_ms_median(), 0.0);
  EXPECT_GT(summary.wall_s(), 0.0);
  EXPECT_EQ(summary.state_hash().size(), 64u);
  ASSERT_EQ(summary.zones_size(), 1);
  EXPECT_EQ(summary.zones(0).name(), "middle");

  const v1::GetSeriesResponse all = series("simulations/x");
  ASSERT_EQ(all.rows_size(), 30);
  EXPECT_FALSE(all.more());
  for (int i = 0; i < 30; ++i) EXPECT_EQ(all.rows(i).step(), static_cast<uint64_t>(i + 1));
  EXPECT_EQ(all.rows(29).probe_thickness_mm_size(), 1);
  EXPECT_EQ(all.rows(29).injected_ml(), summary.injected_ml());
  EXPECT_EQ(series("simulations/x", 25).rows_size(), 5);

  const v1::ComputingCost& cost = summary.cost();
  EXPECT_GT(cost.cpu_ms(), 0.0);
  EXPECT_GT(cost.newton_iterations(), 0u);
  EXPECT_LE(
      cost.element_cpu_ms() + cost.factor_cpu_ms() + cost.solve_cpu_ms() + cost.film_cpu_ms() + cost.coupling_cpu_ms(),
      cost.cpu_ms());
  double cpu_ms = 0.0;
  for (const v1::SeriesRow& row : all.rows()) cpu_ms += row.cost().cpu_ms();
  EXPECT_NEAR(cpu_ms, cost.cpu_ms(), 1e-6 * cost.cpu_ms()) << "the summary is the sum of the series";
}

TEST_F(RunTest, GivesTheSameBytesBesideOthersAndUnderWatch) {
  create(0.3, "alone");
  const std::string hash = await_end("simulations/alone").summary().state_hash();
  std::vector<std::unique_ptr<Watcher>> watchers;
  for (int i = 0; i < 4; ++i) create(0.3, absl::StrCat("x", i), false);
  for (int i = 0; i < 4; ++i) {
    const std::string name = absl::StrCat("simulations/x", i);
    watchers.push_back(std::make_unique<Watcher>(*channel_, watch_request(name, v1::WatchRequest::LATEST)));
    EXPECT_TRUE(start(name).ok());
  }
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(await_end("simulations/x" + std::to_string(i)).summary().state_hash(), hash);
    watchers[static_cast<size_t>(i)]->drain();
    EXPECT_TRUE(watchers[static_cast<size_t>(i)]->finish().ok());
  }
}

TEST_F(RunTest, APreviewComesFirstAndItsDifferenceLast) {
  create(0.3, "plain");
  v1::SimulationSpec spec = square_plan(model_.name(), 0.3);
  spec.set_preview(true);
  v1::Simulation simulation;
  ASSERT_TRUE(create_simulation(spec, "x", false, simulation).ok());
  EXPECT_EQ(simulation.summary().preview().state(), v1::PreviewSummary::PENDING);
  Watcher watcher(*channel_, watch_request("simulations/x", v1::WatchRequest::EVERY));
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_FALSE(frame.slice.preview());
  const size_t skin_bytes = frame.bytes.at("skin.displacement").size();
  ASSERT_TRUE(start("simulations/x").ok());
  SeenFrame preview;
  ASSERT_TRUE(watcher.next(preview));
  EXPECT_TRUE(preview.slice.preview());
  EXPECT_EQ(preview.slice.sequence(), 0u);
  EXPECT_EQ(preview.slice.topology_hash(), frame.slice.topology_hash());
  EXPECT_EQ(preview.bytes.at("skin.displacement").size(), skin_bytes);
  EXPECT_EQ(preview.bytes.count("film/plane.thickness"), 0u) << "the skin only";
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_EQ(frame.slice.sequence(), 1u);
  EXPECT_FALSE(frame.slice.preview());
  watcher.drain();

  const v1::Simulation ended = await_end("simulations/x");
  EXPECT_EQ(ended.state(), v1::Simulation::FINISHED) << ended.reason();
  EXPECT_EQ(ended.summary().state_hash(), await_end("simulations/plain").summary().state_hash());
  const v1::PreviewSummary& told = ended.summary().preview();
  EXPECT_EQ(told.state(), v1::PreviewSummary::DONE) << told.reason();
  EXPECT_GT(told.steps(), 0u);
  EXPECT_LT(told.steps(), ended.summary().steps());
  EXPECT_GT(told.skin_max_displacement_mm(), 0.0);
  EXPECT_TRUE(told.has_difference_max_mm());
  EXPECT_LT(told.difference_max_mm(), ended.summary().skin_max_displacement_mm());
  restart();
  EXPECT_EQ(get_simulation("simulations/x").summary().preview().SerializeAsString(), told.SerializeAsString());
}

TEST_F(RunTest, ResultsSurviveARestart) {
  create(0.2, "x");
  const v1::Simulation before = await_end("simulations/x");
  const std::string rows = series("simulations/x").SerializeAsString();
  SeenFrame last_before;
  Watcher(*channel_, watch_request("simulations/x", v1::WatchRequest::EVERY)).drain(&last_before);
  restart();
  EXPECT_EQ(get_simulation("simulations/x").SerializeAsString(), before.SerializeAsString());
  EXPECT_EQ(series("simulations/x").SerializeAsString(), rows);
  SeenFrame last;
  Watcher watcher(*channel_, watch_request("simulations/x", v1::WatchRequest::EVERY));
  EXPECT_EQ(watcher.drain(&last), 1);
  EXPECT_TRUE(watcher.finish().ok());
  EXPECT_TRUE(last.slice.end());
  EXPECT_EQ(last.slice.sequence(), 20u);
  EXPECT_EQ(last.slice.epoch(), last_before.slice.epoch());
  EXPECT_EQ(last.bytes, last_before.bytes);
  EXPECT_EQ(watcher.meshes.count("skin.points"), 1u);
  EXPECT_EQ(watcher.meshes.count("film/plane.cells"), 1u);
  EXPECT_EQ(watcher.meshes.count("tissue.points"), 0u) << "not asked for";

  // The model is built again from its specification and must be the same one.
  create(0.2, "again");
  EXPECT_EQ(await_end("simulations/again").summary().state_hash(), before.summary().state_hash());
}

TEST_F(RunTest, PausesResumesInjectsAndStops) {
  create(1000.0, "x");
  const std::string name = "simulations/x";
  v1::Simulation paused;
  ASSERT_TRUE(pause(name, &paused).ok());
  EXPECT_EQ(paused.state(), v1::Simulation::PAUSED);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_EQ(get_simulation(name).summary().steps(), paused.summary().steps()) << "it stands still";

  v1::InjectRequest inject;
  inject.set_name(name);
  *inject.mutable_injection() = parse_text<v1::Injection>("zone: 'middle' volume_ml: 0.02 rate_ml_per_s: 0.1");
  v1::Simulation injected;
  ASSERT_TRUE(call(*simulations_, &Simulations::Inject, inject, injected).ok());
  EXPECT_EQ(injected.spec().injections_size(), 2);

  ASSERT_TRUE(resume(name).ok());
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (get_simulation(name).summary().injected_ml() < 0.07 - 1e-9 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  v1::Simulation stopped;
  ASSERT_TRUE(stop(name, &stopped).ok());
  EXPECT_EQ(stopped.state(), v1::Simulation::STOPPED);
  EXPECT_NEAR(stopped.summary().injected_ml(), 0.07, 1e-9);
  EXPECT_EQ(get_simulation(name).state(), v1::Simulation::STOPPED);
  EXPECT_EQ(get_simulation(name).spec().injections_size(), 2);
}

TEST_F(RunTest, RefusesCommandsInWrongStates) {
  create(1000.0, "x", false);
  const std::string name = "simulations/x";
  const grpc::Status early = pause(name);
  EXPECT_EQ(early.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(early.error_message(), HasSubstr("READY"));
  EXPECT_EQ(resume(name).error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  ASSERT_TRUE(start(name).ok());
  EXPECT_THAT(start(name).error_message(), HasSubstr("RUNNING"));
  ASSERT_TRUE(stop(name).ok());
  for (const grpc::Status& late : {start(name), pause(name), resume(name), stop(name)}) {
    EXPECT_EQ(late.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
    EXPECT_THAT(late.error_message(), HasSubstr("STOPPED"));
  }
  EXPECT_EQ(start("simulations/none").error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(RunTest, CreateIsIdempotent) {
  v1::CreateSimulationRequest request;
  request.set_request_id("r-1");
  *request.mutable_spec() = square_plan(model_.name(), 0.1);
  v1::Simulation first, again;
  ASSERT_TRUE(call(*simulations_, &Simulations::CreateSimulation, request, first).ok());
  ASSERT_TRUE(call(*simulations_, &Simulations::CreateSimulation, request, again).ok());
  EXPECT_EQ(first.name(), again.name());
  request.set_start(true);
  EXPECT_EQ(call(*simulations_, &Simulations::CreateSimulation, request, again).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  v1::ListSimulationsResponse all;
  ASSERT_TRUE(call(*simulations_, &Simulations::ListSimulations, v1::ListSimulationsRequest(), all).ok());
  EXPECT_EQ(all.simulations_size(), 1);
}

TEST_F(RunTest, DeletesARunningSimulation) {
  create(1000.0, "x");
  Watcher watcher(*channel_, watch_request("simulations/x", v1::WatchRequest::LATEST));
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  v1::DeleteSimulationRequest request;
  request.set_name("simulations/x");
  google::protobuf::Empty nothing;
  ASSERT_TRUE(call(*simulations_, &Simulations::DeleteSimulation, request, nothing).ok());
  SeenFrame last;
  watcher.drain(&last);
  EXPECT_TRUE(last.slice.end());
  EXPECT_TRUE(watcher.finish().ok());
  EXPECT_EQ(stop("simulations/x").error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(RunTest, RealTimeDoesNotRunAhead) {
  v1::SimulationSpec plan = square_plan(model_.name(), 0.5);
  plan.set_pace(v1::REAL_TIME);
  v1::Simulation simulation;
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(create_simulation(plan, "x", true, simulation).ok());
  EXPECT_EQ(await_end("simulations/x").state(), v1::Simulation::FINISHED);
  // The last step may begin when the time before it is over.
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(480));
}

TEST_F(RunTest, MeasuresTheSkinAgainstATarget) {
  create(0.3, "x", false);
  v1::Scan target;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(30, 0.0), target).ok());
  v1::EvaluateSimulationRequest request;
  request.set_name("simulations/x");
  request.set_target_scan(target.name());
  v1::Evaluation before, after, kept;
  grpc::Status status = call(*simulations_, &Simulations::EvaluateSimulation, request, before);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_NEAR(before.simulated_to_target().max_mm(), 0.0, 1e-4) << "the square lies in the sheet";
  EXPECT_EQ(before.mesh(), "skin");
  EXPECT_EQ(before.vertices_size(), 81);
  ASSERT_TRUE(start("simulations/x").ok());
  const v1::Simulation ended = await_end("simulations/x");
  ASSERT_TRUE(call(*simulations_, &Simulations::EvaluateSimulation, request, after).ok());
  EXPECT_GT(after.simulated_to_target().max_mm(), 0.5 * ended.summary().skin_max_displacement_mm());
  EXPECT_NEAR(after.before_to_target().max_mm(), 0.0, 1e-4);
  EXPECT_EQ(after.distance_mm_size(), 81);
  restart();
  ASSERT_TRUE(call(*simulations_, &Simulations::EvaluateSimulation, request, kept).ok());
  EXPECT_EQ(kept.SerializeAsString(), after.SerializeAsString());
}

class BoundedTest : public ServiceTest {
 protected:
  BoundedTest() : ServiceTest({"--max-simulations", "2"}) {}
};

TEST_F(BoundedTest, RefusesOneSimulationTooMany) {
  create_patient();
  const v1::SimulationSpec plan = square_plan(build_square().name(), 1.0);
  v1::Simulation simulation;
  ASSERT_TRUE(create_simulation(plan, "a", false, simulation).ok());
  ASSERT_TRUE(create_simulation(plan, "b", false, simulation).ok());
  const grpc::Status refused = create_simulation(plan, "c", false, simulation);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(refused.error_message(), HasSubstr("bound is 2"));
  v1::StopSimulationRequest stop;
  stop.set_name("simulations/a");
  ASSERT_TRUE(call(*simulations_, &Simulations::StopSimulation, stop, simulation).ok());
  EXPECT_TRUE(create_simulation(plan, "c", false, simulation).ok());
}

}  // namespace
}  // namespace lipofill::testing
