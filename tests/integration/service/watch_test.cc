// What viewers of a simulation receive.

#include <cstring>
#include <thread>

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using WatchTest = RunTest;

/// That the codes of `coded` stand for the values of `exact`, as closely as they say.
void expect_close(const SeenFrame& exact, const SeenFrame& coded, const std::string& name) {
  const v1::ArraySlice& array = coded.arrays.at(name);
  ASSERT_EQ(array.type(), v1::UINT16);
  const std::string& values = exact.bytes.at(name);
  const std::string& codes = coded.bytes.at(name);
  ASSERT_EQ(codes.size() * 2, values.size());
  EXPECT_GT(array.max_error(), 0.0);
  for (size_t k = 0; k < codes.size() / 2; ++k) {
    uint16_t code = 0;
    float value = 0.0f;
    std::memcpy(&code, codes.data() + 2 * k, sizeof code);
    std::memcpy(&value, values.data() + 4 * k, sizeof value);
    const int c = static_cast<int>(k % 3);
    const double decoded = array.box_min(c) + code / 65535.0 * (array.box_max(c) - array.box_min(c));
    ASSERT_NEAR(decoded, value, array.max_error());
  }
}

TEST_F(WatchTest, EveryViewerGetsEveryFrameAndResumes) {
  create(0.2, "x", false);
  Watcher watcher(*channel_, watch_request("simulations/x", v1::WatchRequest::EVERY));
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame)) << "a READY simulation shows its first frame";
  EXPECT_EQ(frame.slice.sequence(), 0u);
  EXPECT_EQ(frame.slice.topology_hash(), watcher.topology_hash);
  EXPECT_EQ(get_simulation("simulations/x").viewers(), 1u);
  ASSERT_TRUE(start("simulations/x").ok());
  for (uint64_t step = 1; step <= 20; ++step) {
    ASSERT_TRUE(watcher.next(frame));
    EXPECT_EQ(frame.slice.sequence(), step);
    EXPECT_EQ(frame.skipped, 0u);
    EXPECT_EQ(frame.bytes.count("skin.displacement"), 1u);
    EXPECT_EQ(frame.bytes["film/plane.pressure"].size(), 9 * sizeof(float));
  }
  EXPECT_TRUE(frame.slice.end());
  EXPECT_FALSE(watcher.next(frame));
  EXPECT_TRUE(watcher.finish().ok());

  v1::WatchRequest known = watch_request("simulations/x", v1::WatchRequest::EVERY);
  known.set_known_topology_hash(watcher.topology_hash);
  Watcher again(*channel_, known);
  ASSERT_TRUE(again.next(frame));
  EXPECT_TRUE(again.meshes.empty()) << "it has the meshes";
}

TEST_F(WatchTest, ResumesAStreamWhereItBroke) {
  create(1000.0, "x");
  SeenFrame frame;
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::EVERY);
  {
    Watcher watcher(*channel_, request);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(watcher.next(frame));
    watcher.cancel();
    watcher.drain();
    EXPECT_EQ(watcher.finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  ASSERT_TRUE(pause("simulations/x").ok());
  const uint64_t now = get_simulation("simulations/x").summary().steps();
  request.set_seen_epoch(frame.slice.epoch());
  request.set_seen_sequence(now);
  Watcher watcher(*channel_, request);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_TRUE(resume("simulations/x").ok());
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_EQ(frame.slice.sequence(), now + 1);
  ASSERT_TRUE(stop("simulations/x").ok());
}

TEST_F(WatchTest, ThinsFramesByInterval) {
  create(0.2, "x", false);
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::EVERY);
  request.set_interval_ms(60);
  request.add_meshes("skin");
  Watcher watcher(*channel_, request);
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  ASSERT_TRUE(start("simulations/x").ok());
  std::vector<uint64_t> sequences;
  while (watcher.next(frame)) {
    sequences.push_back(frame.slice.sequence());
    EXPECT_EQ(frame.bytes.count("film/plane.pressure"), 0u);
  }
  EXPECT_THAT(sequences, ::testing::ElementsAre(6, 12, 18, 20));
}

TEST_F(WatchTest, ShowsWhatIsAskedFor) {
  create(0.05, "x");
  await_end("simulations/x");
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::LATEST);
  request.add_meshes("tissue");
  Watcher watcher(*channel_, request);
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_EQ(watcher.meshes.count("tissue.cells"), 1u);
  EXPECT_EQ(frame.bytes["tissue.displacement"].size(), watcher.meshes["tissue.points"].size());

  request.set_meshes(0, "bone");
  Watcher lost(*channel_, request);
  EXPECT_FALSE(lost.next(frame));
  const grpc::Status status = lost.finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(violations_of(status).count("meshes[0]"), 1u);
}

TEST_F(WatchTest, SendsTheFieldsAskedForAsCodes) {
  create(0.05, "x", false);
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::EVERY);
  request.add_fields("skin.displacement");
  Watcher exact(*channel_, request);
  request.set_field_type(v1::UINT16);
  Watcher coded(*channel_, request);
  SeenFrame a;
  SeenFrame b;
  ASSERT_TRUE(exact.next(a));
  ASSERT_TRUE(coded.next(b));
  EXPECT_EQ(exact.meshes.count("film/plane.points"), 0u) << "the meshes are those of the fields";
  ASSERT_TRUE(start("simulations/x").ok());
  exact.drain(&a);
  coded.drain(&b);
  ASSERT_TRUE(a.slice.end());
  ASSERT_EQ(a.bytes.size(), 1u);
  expect_close(a, b, "skin.displacement");

  await_end("simulations/x");
  Watcher kept(*channel_, request);
  ASSERT_TRUE(kept.next(b)) << "of the result in the store";
  ASSERT_EQ(b.bytes.size(), 1u);
  expect_close(a, b, "skin.displacement");
}

TEST_F(WatchTest, KeepsToTheRateButShowsThePauseAndTheEnd) {
  create(1000.0, "x", false);
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::LATEST);
  request.set_max_rate_hz(0.001);
  Watcher watcher(*channel_, request);
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_EQ(frame.slice.sequence(), 0u);
  ASSERT_TRUE(start("simulations/x").ok());
  while (get_simulation("simulations/x").summary().steps() < 5) std::this_thread::yield();
  v1::Simulation paused;
  ASSERT_TRUE(pause("simulations/x", &paused).ok());
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_EQ(frame.slice.sequence(), paused.summary().steps());
  EXPECT_EQ(frame.skipped, 0u) << "left out as asked, not for being slow";
  ASSERT_TRUE(resume("simulations/x").ok());
  v1::Simulation stopped;
  ASSERT_TRUE(stop("simulations/x", &stopped).ok());
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_EQ(frame.slice.sequence(), stopped.summary().steps());
  EXPECT_TRUE(frame.slice.end());
}

TEST_F(WatchTest, HearsHeartbeatsWhileNothingHappens) {
  create(0.05, "x", false);
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::LATEST);
  request.set_heartbeat_ms(100);
  Watcher watcher(*channel_, request);
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  std::this_thread::sleep_for(std::chrono::milliseconds(450));
  ASSERT_TRUE(start("simulations/x").ok());
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_GE(watcher.heartbeats.size(), 3u);
  EXPECT_EQ(watcher.heartbeats.at(0).epoch(), frame.slice.epoch());
  EXPECT_EQ(watcher.heartbeats.at(0).sequence(), 0u);
  watcher.drain(&frame);
  EXPECT_TRUE(frame.slice.end());
  EXPECT_TRUE(watcher.finish().ok());
}

TEST_F(WatchTest, AFrameIsAsNewAsTheAcknowledgementBeforeIt) {
  create(1000.0, "x", false);
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::LATEST);
  request.set_max_rate_hz(0.0);
  request.set_max_unacknowledged_frames(1);
  request.set_viewer("surgeon");
  request.set_heartbeat_ms(100);
  Watcher watcher(*channel_, request);
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  ASSERT_TRUE(start("simulations/x").ok());
  for (int round = 0; round < 5; ++round) {
    // The viewer is busy for some steps.
    const uint64_t busy_until = frame.slice.sequence() + 20;
    while (get_simulation("simulations/x").summary().steps() < busy_until) std::this_thread::yield();
    ASSERT_TRUE(acknowledge("surgeon", frame).ok());
    ASSERT_TRUE(watcher.next(frame));
    EXPECT_GE(frame.slice.sequence() + 1, busy_until) << "a step is told a moment before its frame is there";
    EXPECT_GE(frame.skipped, 18u);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  ASSERT_TRUE(stop("simulations/x").ok());
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_TRUE(frame.slice.end()) << "which comes without an acknowledgement";
  ASSERT_FALSE(watcher.heartbeats.empty());
  EXPECT_EQ(watcher.heartbeats.back().unacknowledged_frames(), 1u);
}

}  // namespace
}  // namespace lipofill::testing
