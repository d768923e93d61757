// What a viewer may not ask for, and how it is told.

#include <deque>
#include <functional>

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

using WatchRefusalsTest = RunTest;

TEST_F(WatchRefusalsTest, RefusesAcknowledgementsOfWhatIsNot) {
  create(1000.0, "x", false);
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::LATEST);
  request.set_max_unacknowledged_frames(1);
  request.set_viewer("surgeon");
  Watcher watcher(*channel_, request);
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  EXPECT_EQ(acknowledge("nurse", frame).error_code(), grpc::StatusCode::NOT_FOUND);
  SeenFrame future = frame;
  future.slice.set_sequence(7);
  EXPECT_EQ(violations_of(acknowledge("surgeon", future)).count("sequence"), 1u);
  // The same viewer on a new connection: the daemon need not find out about the old one first.
  Watcher again(*channel_, request);
  ASSERT_TRUE(again.next(frame));
  EXPECT_TRUE(acknowledge("surgeon", frame).ok());
  EXPECT_FALSE(watcher.next(frame));
  EXPECT_EQ(watcher.finish().error_code(), grpc::StatusCode::ABORTED);
}

TEST_F(WatchRefusalsTest, NamesWhatCannotBeWatched) {
  create(0.05, "x", false);
  const auto refused = [this](const std::string& field, const std::function<void(v1::WatchRequest&)>& change) {
    v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::EVERY);
    change(request);
    Watcher watcher(*channel_, request);
    SeenFrame frame;
    EXPECT_FALSE(watcher.next(frame)) << field;
    const grpc::Status status = watcher.finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << field;
    EXPECT_EQ(violations_of(status).count(field), 1u) << field << ": " << status.error_message();
  };
  refused("fields[0]", [](v1::WatchRequest& request) { request.add_fields("skin.colour"); });
  refused("fields[0]", [](v1::WatchRequest& request) {
    request.add_meshes("tissue");
    request.add_fields("skin.pressure");
  });
  refused("heartbeat_ms", [](v1::WatchRequest& request) { request.set_heartbeat_ms(1.0); });
  refused("viewer", [](v1::WatchRequest& request) { request.set_max_unacknowledged_frames(1); });
  refused("viewer", [](v1::WatchRequest& request) { request.set_viewer("surgeon"); });
  refused("viewer", [](v1::WatchRequest& request) {
    request.set_max_unacknowledged_frames(1);
    request.set_viewer("The Surgeon");
  });
  refused("max_unacknowledged_frames", [](v1::WatchRequest& request) {
    request.set_max_unacknowledged_frames(2000);
    request.set_viewer("surgeon");
  });
  refused("field_type", [](v1::WatchRequest& request) { request.set_field_type(v1::UINT8); });
  refused("max_rate_hz", [](v1::WatchRequest& request) { request.set_max_rate_hz(10.0); });
  refused("max_rate_hz", [](v1::WatchRequest& request) {
    request.set_delivery(v1::WatchRequest::LATEST);
    request.set_max_rate_hz(1001.0);
  });
}

class FewViewersTest : public ServiceTest {
 protected:
  FewViewersTest() : ServiceTest({"--max-viewers", "2"}) {}
  /// Whether a new viewer is shown a frame; with the reason where not.
  bool can_watch(grpc::Status& status) {
    v1::WatchRequest request;
    request.set_simulation("simulations/x");
    Watcher watcher(*channel_, request);
    SeenFrame frame;
    if (watcher.next(frame)) {
      watcher.cancel();
      watcher.drain();
      watcher.finish();
      return true;
    }
    status = watcher.finish();
    return false;
  }
};

TEST_F(FewViewersTest, RefusesOneViewerTooMany) {
  create_patient();
  v1::Simulation simulation;
  ASSERT_TRUE(create_simulation(square_plan(build_square().name(), 1.0), "x", false, simulation).ok());
  v1::WatchRequest request;
  request.set_simulation("simulations/x");
  std::deque<Watcher> watchers;
  SeenFrame frame;
  for (int k = 0; k < 2; ++k) ASSERT_TRUE(watchers.emplace_back(*channel_, request).next(frame));
  grpc::Status status;
  EXPECT_FALSE(can_watch(status));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("the bound is 2"));
  watchers[0].cancel();
  watchers[0].drain();
  watchers[0].finish();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  bool is_free_again = false;
  while (!is_free_again && std::chrono::steady_clock::now() < deadline) is_free_again = can_watch(status);
  EXPECT_TRUE(is_free_again) << status.error_message();
  watchers[1].cancel();
  watchers[1].drain();
  watchers[1].finish();
}

}  // namespace
}  // namespace lipofill::testing
