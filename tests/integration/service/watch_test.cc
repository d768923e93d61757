// What viewers of a simulation receive.

#include <thread>

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using WatchTest = RunTest;

TEST_F(WatchTest, EveryViewerGetsEveryFrameAndResumes) {
  create(0.2, "x", false);
  Watcher watcher(*channel_, watch_request("simulations/x", v1::WatchRequest::EVERY));
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame)) << "a READY simulation shows its first frame";
  EXPECT_EQ(frame.slice.sequence(), 0u);
  EXPECT_EQ(frame.slice.topology_hash(), watcher.topology_hash);
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

}  // namespace
}  // namespace lipofill::testing
