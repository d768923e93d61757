// Fifty viewers of one simulation - reading, slow, stalled, killed, frozen - and the simulation
// does not notice.

#include <signal.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/integration/service/footprint.h"
#include "tests/integration/service/spectator.h"
#include "tests/integration/service/viewer_process.h"

namespace lipofill::testing {
namespace {

constexpr int kEach = 5;
constexpr uint64_t kSteps = 3000;

class CrowdTest : public ServiceTest {
 protected:
  CrowdTest() : ServiceTest({"--keepalive-s", "1", "--keepalive-timeout-s", "4"}) {
    create_patient();
    v1::ModelSpec spec = square_spec();
    // Frames of 75 kB from cheap steps: a skin that nothing moves, over a film with a wall of its
    // own.
    spec.clear_layers();
    spec.set_n_xi(60);
    spec.set_n_eta(60);
    v1::Operation operation;
    EXPECT_TRUE(build("patients/anna", spec, operation).ok());
    v1::Model model;
    EXPECT_TRUE(operation.response().UnpackTo(&model)) << operation.error().message();
    plan_ = parse_text<v1::SimulationSpec>(R"(
      films { name: "wide" n_xi: 4 n_eta: 4 zones { name: "all" box { xi_min: 0 xi_max: 1 eta_min: 0 eta_max: 1 } }
        wall { kind: WINKLER stiffness_kpa_per_mm: 10 } }
      injections { zone: "all" volume_ml: 0.1 rate_ml_per_s: 0.1 start_s: 0 }
      time { settle_skin_speed_mm_per_s: 0 })");
    plan_.set_model(model.name());
    plan_.mutable_time()->set_end_s(0.01 * kSteps);
  }

  void create(const std::string& id, bool start) {
    v1::Simulation simulation;
    const grpc::Status status = create_simulation(plan_, id, start, simulation);
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
  void start_crowd() {
    v1::StartSimulationRequest request;
    request.set_name("simulations/crowd");
    v1::Simulation simulation;
    ASSERT_TRUE(call(*simulations_, &v1::SimulationService::Stub::StartSimulation, request, simulation).ok());
  }
  /// A viewer that has seen the first frame; one with a name acknowledges.
  Spectator& add(v1::WatchRequest::Delivery delivery, const std::string& name = "") {
    v1::WatchRequest request;
    request.set_simulation("simulations/crowd");
    request.set_delivery(delivery);
    request.set_max_rate_hz(0.0);
    request.set_viewer(name);
    request.set_max_unacknowledged_frames(name.empty() ? 0 : 1);
    Spectator& added = spectators_.emplace_back(daemon_->address(), request);
    EXPECT_TRUE(added.next());
    return added;
  }
  void add_process(bool every) {
    const std::string output = directory_.file(absl::StrCat("viewer", processes_.size()));
    processes_.emplace_back(daemon_->address(), "simulations/crowd", every, output);
  }

  uint64_t steps() { return get_simulation("simulations/crowd").summary().steps(); }
  /// The largest of the daemon's memory until the step.
  double peak_mb_until(uint64_t step) {
    double peak_mb = 0.0;
    while (steps() < step) {
      peak_mb = std::max(peak_mb, read_footprint(daemon_->pid()).resident_mb);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return peak_mb;
  }
  int await_sockets(int n) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    int sockets = 0;
    while ((sockets = read_footprint(daemon_->pid()).sockets) > n && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return sockets;
  }

  void note(uint64_t sequence) {
    uint64_t newest = newest_;
    while (newest < sequence && !newest_.compare_exchange_weak(newest, sequence)) continue;
  }
  void read_latest(Spectator& me) {
    for (uint64_t last = 0; me.next(); last = me.sequence()) {
      EXPECT_GT(me.sequence(), last);
      note(me.sequence());
    }
    EXPECT_TRUE(me.finish().ok());
    EXPECT_TRUE(me.saw_end());
  }
  void read_every(Spectator& me) {
    for (uint64_t due = 1; me.next(); ++due) {
      EXPECT_EQ(me.sequence(), due);
      note(me.sequence());
    }
    const grpc::StatusCode code = me.finish().error_code();
    EXPECT_EQ(code, me.saw_end() ? grpc::StatusCode::OK : grpc::StatusCode::RESOURCE_EXHAUSTED) << "a clear end";
  }
  /// What others saw before it acknowledges it sees next or has passed, but for the step under way.
  void read_and_acknowledge(Spectator& me, std::chrono::milliseconds pause) {
    uint64_t newest = 0;
    do {
      EXPECT_GE(me.sequence() + 1, newest);
      std::this_thread::sleep_for(pause);
      newest = newest_;
      if (!me.saw_end()) (void)me.acknowledge();  // NOT_FOUND when the last frame overtook it
    } while (me.next());
    EXPECT_TRUE(me.finish().ok());
    EXPECT_TRUE(me.saw_end());
  }

  v1::SimulationSpec plan_;
  std::atomic<uint64_t> newest_ = 0;
  std::deque<Spectator> spectators_;
  std::deque<ViewerProcess> processes_;
};

TEST_F(CrowdTest, CostsTheSimulationNothing) {
  create("alone", true);
  const v1::Simulation alone = await_end("simulations/alone");
  ASSERT_EQ(alone.summary().steps(), kSteps) << alone.reason();

  create("crowd", false);
  const int sockets_before = read_footprint(daemon_->pid()).sockets;
  std::deque<Spectator*> acting;
  std::deque<Spectator*> stalled_latest;
  std::deque<Spectator*> stalled_every;
  for (int k = 0; k < kEach; ++k) {
    acting.push_back(&add(v1::WatchRequest::LATEST));
    acting.back()->run([this](Spectator& me) { read_latest(me); });
    acting.push_back(&add(v1::WatchRequest::LATEST, absl::StrCat("brisk-", k)));
    acting.back()->run([this](Spectator& me) { read_and_acknowledge(me, std::chrono::milliseconds(0)); });
    acting.push_back(&add(v1::WatchRequest::LATEST, absl::StrCat("slow-", k)));
    acting.back()->run([this](Spectator& me) { read_and_acknowledge(me, std::chrono::milliseconds(100)); });
    acting.push_back(&add(v1::WatchRequest::EVERY));
    acting.back()->run([this](Spectator& me) { read_every(me); });
    stalled_latest.push_back(&add(v1::WatchRequest::LATEST));
    stalled_every.push_back(&add(v1::WatchRequest::EVERY));
  }
  for (int k = 0; k < 4 * kEach; ++k) add_process(k % 2 == 0);
  for (const ViewerProcess& process : processes_) ASSERT_TRUE(process.await_frame());
  ASSERT_EQ(spectators_.size() + processes_.size(), 50u);

  start_crowd();
  peak_mb_until(kSteps / 10);
  for (size_t k = 0; k < processes_.size(); ++k) processes_[k].signal(k % 4 < 2 ? SIGKILL : SIGSTOP);
  const double first_peak_mb = peak_mb_until(kSteps / 2);
  const double last_peak_mb = peak_mb_until(kSteps * 19 / 20);
  EXPECT_LE(last_peak_mb, 1.1 * first_peak_mb);
  const v1::Simulation crowd = await_end("simulations/crowd");
  EXPECT_EQ(crowd.summary().state_hash(), alone.summary().state_hash());
  for (Spectator* spectator : acting) spectator->join();
  for (Spectator* stalled : stalled_latest) {
    while (stalled->next()) continue;
    EXPECT_TRUE(stalled->saw_end());
    EXPECT_TRUE(stalled->finish().ok());
  }
  for (Spectator* stalled : stalled_every) {
    while (stalled->next()) continue;
    EXPECT_EQ(stalled->finish().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  }
  // A connection takes the caller's socket and the two ends of the inner one.
  const int living = sockets_before + 3 * static_cast<int>(spectators_.size());
  EXPECT_LE(await_sockets(living), living) << "of the killed and the frozen none is left";
  EXPECT_TRUE(is_serving());
}

}  // namespace
}  // namespace lipofill::testing
