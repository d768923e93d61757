// What cannot be brought back at a start says what it waits for, and comes back by itself; what has
// yet to catch up says so; and daemons that die again and again get further each time.

#include <filesystem>
#include <thread>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

namespace fs = std::filesystem;
using grpc::StatusCode;
using ::testing::HasSubstr;
using Simulations = v1::SimulationService::Stub;

/// The step that the log says a simulation went on from at the last start.
uint64_t last_ground(const std::string& log) {
  const std::string mark = "goes on from step ";
  const size_t at = log.rfind(mark);
  uint64_t step = 0;
  if (at == std::string::npos) return step;
  const size_t begin = at + mark.size();
  EXPECT_TRUE(absl::SimpleAtoi(log.substr(begin, log.find_first_not_of("0123456789", begin) - begin), &step));
  return step;
}

class RecoveryTest : public RunTest {
 protected:
  explicit RecoveryTest(std::vector<std::string> arguments = {"--checkpoint-interval-s", "0.05"})
      : RunTest(std::move(arguments)) {}

  fs::path data() const { return directory_.path() / "data"; }
  /// A model on a scan, so that there is a file to miss.
  v1::Model build_on_scan() {
    EXPECT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(60), scan_).ok());
    v1::ModelSpec spec = square_spec();
    spec.mutable_scan_region()->set_scan(scan_.name());
    for (const auto& [x, y] : std::vector<std::pair<double, double>>{{25, 25}, {75, 25}, {75, 75}, {25, 75}}) {
      auto* position = spec.mutable_scan_region()->add_corners()->mutable_position_mm();
      position->set_x(x);
      position->set_y(y);
      position->set_z(4.5);
    }
    *spec.mutable_scan_region()->mutable_axes() =
        parse_text<v1::HeadAxes>("left { x: 1 y: 0 z: 0 } up { x: 0 y: 1 z: 0 } forward { x: 0 y: 0 z: 1 }");
    v1::Operation operation;
    EXPECT_TRUE(build("patients/anna", spec, operation).ok());
    v1::Model model;
    EXPECT_TRUE(operation.response().UnpackTo(&model)) << operation.error().message();
    return model;
  }
  /// Polls until a simulation is back and has caught up.
  v1::Simulation await_back(const std::string& name) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    v1::Simulation simulation = get_simulation(name);
    while (simulation.has_recovery() && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      simulation = get_simulation(name);
    }
    EXPECT_FALSE(simulation.has_recovery()) << simulation.recovery().ShortDebugString();
    return simulation;
  }
  grpc::Status watch(const std::string& name) {
    Watcher watcher(*channel_, watch_request(name, v1::WatchRequest::LATEST));
    SeenFrame frame;
    if (watcher.next(frame)) watcher.cancel();
    return watcher.finish();
  }
  void await_step(const std::string& name, uint64_t step) {
    while (get_simulation(name).summary().steps() < step && !HasFailure()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  v1::Scan scan_;
};

TEST_F(RecoveryTest, WithoutItsFileAtTheStartItWaitsSaysSoAndComesBack) {
  const v1::Model model = build_on_scan();
  v1::Simulation made;
  ASSERT_TRUE(create_simulation(square_plan(model.name(), 3.0), "unbroken", true, made).ok());
  const std::string hash = await_end("simulations/unbroken").summary().state_hash();
  v1::SimulationSpec plan = square_plan(model.name(), 3.0);
  plan.set_pace(v1::REAL_TIME);
  ASSERT_TRUE(create_simulation(plan, "x", true, made).ok());
  create(1e5, "other");
  await_step("simulations/x", 20);
  daemon_->kill_hard();
  const fs::path file = data() / "scans" / "anna" / scan_.name().substr(scan_.name().rfind('/') + 1);
  fs::rename(file, directory_.file("away"));
  connect();

  const v1::Simulation waiting = get_simulation("simulations/x");
  EXPECT_EQ(waiting.state(), v1::Simulation::RUNNING) << "that is what it was told to be";
  ASSERT_TRUE(waiting.has_recovery());
  EXPECT_THAT(waiting.recovery().waiting_for(), HasSubstr(scan_.name()));
  EXPECT_GE(waiting.recovery().attempts(), 1u);
  EXPECT_TRUE(waiting.recovery().has_next_attempt_time());
  EXPECT_THAT(waiting.reason(), HasSubstr("it waits for this"));
  for (const grpc::Status& refused : {pause("simulations/x"), watch("simulations/x")}) {
    EXPECT_EQ(refused.error_code(), StatusCode::UNAVAILABLE) << refused.error_message();
    EXPECT_THAT(refused.error_message(), HasSubstr(scan_.name()));
    EXPECT_THAT(refused.error_message(), HasSubstr("tries again in"));
  }
  v1::ListSimulationsResponse listed;
  ASSERT_TRUE(call(*simulations_, &Simulations::ListSimulations, v1::ListSimulationsRequest(), listed).ok());
  EXPECT_EQ(std::count_if(listed.simulations().begin(), listed.simulations().end(),
                          [](const v1::Simulation& s) { return s.recovery().attempts() > 0; }),
            1);
  EXPECT_FALSE(get_simulation("simulations/other").has_recovery()) << "the others do not suffer from it";

  fs::rename(directory_.file("away"), file);
  await_back("simulations/x");
  EXPECT_EQ(await_end("simulations/x").summary().state_hash(), hash);
}

TEST_F(RecoveryTest, OneThatWaitsCanBeDeleted) {
  const v1::Model model = build_on_scan();
  v1::Simulation made;
  ASSERT_TRUE(create_simulation(square_plan(model.name(), 1e5), "x", true, made).ok());
  daemon_->kill_hard();
  fs::remove_all(data() / "scans" / "anna");
  connect();
  ASSERT_TRUE(get_simulation("simulations/x").has_recovery());
  v1::DeleteSimulationRequest request;
  request.set_name("simulations/x");
  google::protobuf::Empty nothing;
  EXPECT_TRUE(call(*simulations_, &Simulations::DeleteSimulation, request, nothing).ok());
  EXPECT_EQ(pause("simulations/x").error_code(), StatusCode::NOT_FOUND);
}

/// Nothing is kept of a run but its commands.
class CatchingUpTest : public RecoveryTest {
 protected:
  CatchingUpTest() : RecoveryTest({"--checkpoint-interval-s", "0"}) {}
};

TEST_F(CatchingUpTest, FiguresOfAnEarlierStepAreMarkedAsSuch) {
  create(1e5, "x");
  await_step("simulations/x", 1500);
  v1::Simulation paused;
  ASSERT_TRUE(pause("simulations/x", &paused).ok());
  const uint64_t step = paused.summary().steps();
  restart_hard();
  int earlier = 0;
  v1::Simulation now = get_simulation("simulations/x");
  for (; now.has_recovery() && !HasFailure(); now = get_simulation("simulations/x")) {
    ++earlier;
    EXPECT_EQ(now.recovery().until_step(), step);
    EXPECT_EQ(now.recovery().waiting_for(), "");
    EXPECT_EQ(now.state(), v1::Simulation::PAUSED);
    EXPECT_LE(now.summary().steps(), step);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_GT(earlier, 0);
  EXPECT_EQ(now.summary().steps(), step) << "without the mark it is where it was acknowledged to be";
  EXPECT_EQ(now.summary().state_hash(), paused.summary().state_hash());
}

/// Checkpoints as far apart as they are by default, ten seconds.
class DyingOftenTest : public RecoveryTest {
 protected:
  DyingOftenTest() : RecoveryTest({}) {}
};

TEST_F(DyingOftenTest, EachLifeShorterThanTheIntervalGetsFurther) {
  create(1e6, "x");
  await_step("simulations/x", 10);
  uint64_t ground = 0;
  for (int life = 0; life < 4; ++life) {
    restart_hard();
    const uint64_t next = last_ground(daemon_->log());
    EXPECT_TRUE(life == 0 || next > ground) << "life " << life << " goes on from step " << next << " as the one before";
    ground = next;
    await_step("simulations/x", ground + 200);
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
  }
}

TEST_F(DyingOftenTest, EachLifeGetsFurtherAlsoWhileItCatchesUp) {
  create(1e6, "x");
  await_step("simulations/x", 3000);
  v1::InjectRequest request;
  request.set_name("simulations/x");
  *request.mutable_injection() = parse_text<v1::Injection>("zone: 'middle' volume_ml: 0.02 rate_ml_per_s: 0.1");
  v1::Simulation injected;
  ASSERT_TRUE(call(*simulations_, &Simulations::Inject, request, injected).ok());
  const uint64_t until = injected.summary().steps();
  uint64_t ground = 0;
  for (int life = 0; life < 6 && !HasFailure(); ++life) {
    restart_hard();
    const uint64_t next = last_ground(daemon_->log());
    EXPECT_TRUE(life == 0 || next > ground) << "life " << life << " goes on from step " << next << " as the one before";
    ground = next;
    // Lives of some hundred steps, far fewer than there are to repeat.
    await_step("simulations/x", ground + 50);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
  }
  const v1::Simulation now = await_back("simulations/x");
  EXPECT_GE(now.summary().steps(), until);
  EXPECT_EQ(now.spec().injections_size(), 2);
  EXPECT_EQ(now.spec().injections(1).SerializeAsString(), injected.spec().injections(1).SerializeAsString());
  ASSERT_TRUE(stop("simulations/x").ok());
}

}  // namespace
}  // namespace lipofill::testing
