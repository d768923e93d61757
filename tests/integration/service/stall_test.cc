// Viewers that do not read: they cost themselves frames or their stream, never the simulation.

#include <deque>
#include <thread>

#include "tests/integration/service/footprint.h"
#include "tests/integration/service/spectator.h"

namespace lipofill::testing {
namespace {

class StallTest : public ServiceTest {
 protected:
  StallTest() {
    create_patient();
    plan_ = parse_text<v1::SimulationSpec>(R"(
      films { name: "wide" n_xi: 4 n_eta: 4 zones { name: "all" box { xi_min: 0 xi_max: 1 eta_min: 0 eta_max: 1 } }
        wall { kind: WINKLER stiffness_kpa_per_mm: 10 } }
      injections { zone: "all" volume_ml: 0.1 rate_ml_per_s: 0.1 start_s: 0 }
      time { settle_skin_speed_mm_per_s: 0 })");
    // The transport's buffers are full soon.
    use_skin_of(200);
  }

  /// Large frames from cheap steps: a fine skin that nothing moves, over a film with a wall of its
  /// own.
  void use_skin_of(uint32_t divisions) {
    v1::ModelSpec spec = square_spec();
    spec.clear_layers();
    spec.set_n_xi(divisions);
    spec.set_n_eta(divisions);
    v1::Operation operation;
    const grpc::Status status = build("patients/anna", spec, operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    v1::Model model;
    EXPECT_TRUE(operation.response().UnpackTo(&model)) << operation.error().message();
    plan_.set_model(model.name());
  }

  v1::WatchRequest watch_request(v1::WatchRequest::Delivery delivery) {
    v1::WatchRequest request;
    request.set_simulation("simulations/x");
    request.set_delivery(delivery);
    request.set_max_rate_hz(0.0);
    return request;
  }
  void start(double end_s) {
    plan_.mutable_time()->set_end_s(end_s);
    v1::Simulation simulation;
    const grpc::Status status = create_simulation(plan_, "x", true, simulation);
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
  uint64_t steps() { return get_simulation("simulations/x").summary().steps(); }
  void await_steps(uint64_t n) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (steps() < n && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_GE(steps(), n);
  }

  v1::SimulationSpec plan_;
};

TEST_F(StallTest, LatestSkipsFramesAndTellsHowMany) {
  start(1.5);
  Watcher stalled(*channel_, watch_request(v1::WatchRequest::LATEST));
  SeenFrame frame;
  ASSERT_TRUE(stalled.next(frame));
  const uint64_t first = frame.slice.sequence();
  // A reader beside it, on a connection of its own, sees the simulation through.
  auto other = grpc::CreateChannel(daemon_->address(), grpc::InsecureChannelCredentials());
  Watcher reader(*other, watch_request(v1::WatchRequest::LATEST));
  SeenFrame last;
  EXPECT_GT(reader.drain(&last), 0);
  EXPECT_TRUE(reader.finish().ok());
  EXPECT_TRUE(last.slice.end());
  EXPECT_EQ(await_end("simulations/x").state(), v1::Simulation::FINISHED);

  uint64_t seen = 0;
  uint64_t skipped = 0;
  while (stalled.next(frame)) {
    ++seen;
    skipped += frame.skipped;
  }
  EXPECT_TRUE(stalled.finish().ok());
  EXPECT_TRUE(frame.bytes.empty() || frame.slice.end());
  EXPECT_EQ(first + seen + skipped, last.slice.sequence()) << "each frame is seen or counted";
}

TEST_F(StallTest, EveryEndsWithResourceExhausted) {
  start(3600.0);
  Watcher stalled(*channel_, watch_request(v1::WatchRequest::EVERY));
  SeenFrame frame;
  ASSERT_TRUE(stalled.next(frame));
  size_t frame_bytes = 0;
  for (const auto& [name, bytes] : frame.bytes) frame_bytes += bytes.size();
  ASSERT_GT(frame_bytes, 100'000u);
  // Enough to fill the queue of 64 MiB and what the transport holds.
  await_steps(frame.slice.sequence() + (size_t{90} << 20) / frame_bytes);
  stalled.drain();
  const grpc::Status status = stalled.finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  const uint64_t now = steps();
  await_steps(now + 3);
}

TEST_F(StallTest, ViewersOfAResultShareItsBytes) {
  // Meshes and frame are 11 MB, of which a viewer's own connection takes up to 4.
  use_skin_of(500);
  start(0.01);
  ASSERT_EQ(await_end("simulations/x").state(), v1::Simulation::FINISHED);
  const v1::WatchRequest request = watch_request(v1::WatchRequest::LATEST);
  std::deque<Spectator> stalled;
  stalled.emplace_back(daemon_->address(), request).await_sending();
  const double of_one_mb = read_footprint(daemon_->pid()).resident_mb;
  for (int k = 0; k < 14; ++k) stalled.emplace_back(daemon_->address(), request).await_sending();
  EXPECT_LT(read_footprint(daemon_->pid()).resident_mb, of_one_mb + 50.0);
}

TEST_F(StallTest, CancelledViewersAreForgotten) {
  start(3600.0);
  for (int i = 0; i < 20; ++i) {
    Watcher watcher(*channel_, watch_request(v1::WatchRequest::EVERY));
    SeenFrame frame;
    ASSERT_TRUE(watcher.next(frame));
    watcher.cancel();
    watcher.drain();
    EXPECT_EQ(watcher.finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  const uint64_t now = steps();
  await_steps(now + 3);
  EXPECT_TRUE(is_serving());
}

}  // namespace
}  // namespace lipofill::testing
