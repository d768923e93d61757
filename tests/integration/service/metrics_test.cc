// What Prometheus scrapes from the real daemon, and whether the dashboard asks for anything that is
// not there.

#include <httplib.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

class MetricsTest : public ServiceTest {
 protected:
  MetricsTest() : ServiceTest({"--metrics-listen", "127.0.0.1:0"}) {}

  int metrics_port() {
    std::smatch match;
    const std::string log = daemon_->log();
    EXPECT_TRUE(std::regex_search(log, match, std::regex(R"(metrics at .* \(port (\d+)\))"))) << log;
    return match.empty() ? 0 : std::stoi(match[1]);
  }
  std::string scrape() {
    httplib::Client client("127.0.0.1", metrics_port());
    const auto response = client.Get("/metrics");
    EXPECT_TRUE(response);
    if (!response) return "";
    EXPECT_EQ(response->status, 200);
    EXPECT_THAT(response->get_header_value("Content-Type"), HasSubstr("text/plain; version=0.0.4"));
    return response->body;
  }
  /// Values by name and labels, as they stand in the scrape.
  static std::map<std::string, double> values_of(const std::string& text) {
    std::map<std::string, double> values;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      const size_t space = line.rfind(' ');
      if (!line.empty() && line[0] != '#') values[line.substr(0, space)] = std::stod(line.substr(space + 1));
    }
    return values;
  }

  /// The daemon lets go of a viewer just after that has seen its stream end.
  std::map<std::string, double> await_no_viewers() {
    auto values = values_of(scrape());
    for (int i = 0; i < 500 && values["lipofill_viewers"] != 0.0; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      values = values_of(scrape());
    }
    EXPECT_EQ(values["lipofill_viewers"], 0.0);
    return values;
  }

  /// A simulation of a second, watched, that has ended.
  v1::Simulation run_one() {
    create_patient();
    const v1::Model model = build_square();
    v1::Simulation simulation;
    EXPECT_TRUE(create_simulation(square_plan(model.name(), 1.0), "x", false, simulation).ok());
    v1::WatchRequest watch;
    watch.set_simulation("simulations/x");
    watch.set_delivery(v1::WatchRequest::EVERY);
    Watcher watcher(*channel_, watch);
    SeenFrame first;
    EXPECT_TRUE(watcher.next(first));
    EXPECT_EQ(values_of(scrape())["lipofill_viewers"], 1.0);
    EXPECT_EQ(values_of(scrape())["lipofill_simulations{state=\"READY\"}"], 1.0);
    v1::CreateCheckpointRequest keep;
    keep.set_parent("simulations/x");
    v1::Checkpoint checkpoint;
    EXPECT_TRUE(call(*simulations_, &v1::SimulationService::Stub::CreateCheckpoint, keep, checkpoint).ok());
    v1::StartSimulationRequest start;
    start.set_name("simulations/x");
    EXPECT_TRUE(call(*simulations_, &v1::SimulationService::Stub::StartSimulation, start, simulation).ok());
    EXPECT_EQ(watcher.drain(), 100);
    return await_end("simulations/x");
  }
};

TEST_F(MetricsTest, SayWhatWasDone) {
  const v1::Simulation simulation = run_one();
  v1::GetPatientRequest nobody;
  nobody.set_name("patients/nobody");
  v1::Patient patient;
  call(*patients_, &v1::PatientService::Stub::GetPatient, nobody, patient);

  auto values = await_no_viewers();
  const v1::Summary& summary = simulation.summary();
  EXPECT_EQ(values["lipofill_steps_total"], static_cast<double>(summary.steps()));
  EXPECT_EQ(values["lipofill_step_wall_seconds_count"], static_cast<double>(summary.steps()));
  EXPECT_EQ(values["lipofill_step_cpu_seconds_count{phase=\"film\"}"], static_cast<double>(summary.steps()));
  const v1::ComputingCost& cost = summary.cost();
  EXPECT_NEAR(values["lipofill_step_cpu_seconds_sum{phase=\"element\"}"], 1e-3 * cost.element_cpu_ms(),
              1e-6 * cost.cpu_ms());
  EXPECT_EQ(values["lipofill_solver_iterations_total{kind=\"newton\"}"], static_cast<double>(cost.newton_iterations()));
  EXPECT_EQ(values["lipofill_solver_factorisations_total"], static_cast<double>(cost.factorisations()));
  EXPECT_EQ(values["lipofill_solver_fallbacks_total"], static_cast<double>(cost.fallbacks()));
  EXPECT_EQ(values["lipofill_simulations_ended_total{state=\"FINISHED\"}"], 1.0);
  EXPECT_EQ(values["lipofill_simulations{state=\"RUNNING\"}"], 0.0);
  EXPECT_EQ(values["lipofill_frames_sent_total"], 101.0);
  EXPECT_EQ(values["lipofill_frames_skipped_total"], 0.0);
  EXPECT_GT(values["lipofill_rpc_sent_bytes_total{method=\"/lipofill.v1.FrameService/Watch\"}"], 100'000.0);
  EXPECT_EQ(values["lipofill_rpc_handled_total{code=\"OK\",method=\"/lipofill.v1.FrameService/Watch\"}"], 1.0);
  EXPECT_EQ(values["lipofill_rpc_handled_total{code=\"NOT_FOUND\",method=\"/lipofill.v1.PatientService/GetPatient\"}"],
            1.0);
  EXPECT_EQ(values["lipofill_rpc_in_flight{method=\"/lipofill.v1.FrameService/Watch\"}"], 0.0);
  EXPECT_GE(values["lipofill_checkpoints_total{outcome=\"written\"}"], 1.0);
  EXPECT_GT(values["lipofill_checkpoint_bytes_total"], 1000.0);
  EXPECT_EQ(values["lipofill_checkpoints_total{outcome=\"failed\"}"], 0.0);
  EXPECT_EQ(values["lipofill_workers"], 2.0);
  EXPECT_GT(values["process_resident_memory_bytes"], 1e7);
  EXPECT_GT(values["process_cpu_seconds_total"], 0.0);
}

TEST_F(MetricsTest, CountShapes) {
  create_patient();
  v1::FindShapeRequest request;
  *request.mutable_spec() = square_plan(build_square().name(), 600.0);
  request.set_drag("slider");
  for (const double volume_ml : {0.04, 0.05, 1e4}) {
    request.clear_injections();
    request.add_injections()->set_volume_ml(volume_ml);
    Context context;
    const auto stream = simulations_->FindShape(&context, request);
    v1::FindShapeResponse response;
    while (stream->Read(&response)) continue;
    EXPECT_EQ(stream->Finish().ok(), volume_ml < 1.0);
  }
  const auto values = values_of(scrape());
  EXPECT_EQ(values.at("lipofill_shapes_found_total"), 2.0);
  EXPECT_EQ(values.at("lipofill_shapes_refused_total"), 1.0);
  EXPECT_EQ(values.at("lipofill_shapes_superseded_total"), 0.0);
  EXPECT_EQ(values.at("lipofill_shape_wall_seconds_count"), 2.0);
  EXPECT_EQ(values.at("lipofill_shape_drags"), 1.0);
}

TEST_F(MetricsTest, HaveAllThatTheDashboardAsksFor) {
  run_one();
  std::set<std::string> known;
  for (const auto& [name, value] : values_of(scrape())) known.insert(name.substr(0, name.find('{')));
  std::ifstream file(LIPOFILL_DEPLOY "/grafana/lipofill.json");
  const auto dashboard = nlohmann::json::parse(file);
  const std::regex metric(R"(\b(lipofill|process)_[a-z_]+\b)");
  int n_expressions = 0;
  for (const auto& panel : dashboard["panels"]) {
    if (!panel.contains("targets")) continue;
    for (const auto& target : panel["targets"]) {
      const std::string expression = target["expr"];
      ++n_expressions;
      std::sregex_iterator found(expression.begin(), expression.end(), metric);
      EXPECT_NE(found, std::sregex_iterator()) << expression;
      for (; found != std::sregex_iterator(); ++found) {
        EXPECT_TRUE(known.contains(found->str())) << found->str() << " of panel " << panel["title"];
      }
    }
  }
  EXPECT_GE(n_expressions, 15);
}

TEST_F(MetricsTest, AreAllThatIsServedThere) {
  httplib::Client client("127.0.0.1", metrics_port());
  EXPECT_EQ(client.Get("/")->status, 404);
  EXPECT_EQ(client.Post("/metrics", "x", "text/plain")->status, 413);
  EXPECT_EQ(client.Get("/metrics")->status, 200);
}

TEST(MetricsPort, IsNotSharedUnnoticed) {
  httplib::Server other;
  const int port = other.bind_to_any_port("127.0.0.1");
  TemporaryDirectory directory;
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--listen", "127.0.0.1:0", "--data", directory.file("data"), "--metrics-listen",
                               "127.0.0.1:" + std::to_string(port)},
                              output),
            1);
  EXPECT_THAT(output, HasSubstr("metrics: cannot listen on"));
}

}  // namespace
}  // namespace lipofill::testing
