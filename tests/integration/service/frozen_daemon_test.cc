// The library's watch on a daemon that freezes: no connection breaks, nothing comes.

#include <signal.h>

#include <algorithm>
#include <future>
#include <latch>

#include "client/cpp/frame_watcher.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

class FrozenDaemonTest : public RunTest {
 protected:
  v1::WatchRequest request() {
    v1::WatchRequest result = watch_request("simulations/x", v1::WatchRequest::LATEST);
    result.set_heartbeat_ms(250);
    result.set_max_unacknowledged_frames(1);
    return result;
  }
  client::WatchHandlers handlers() {
    client::WatchHandlers result;
    result.on_meshes = [this](const client::Meshes&) {
      ++meshes_;
      return absl::OkStatus();
    };
    result.on_frame = [this](const client::Frame& frame) {
      sequences_.push_back(frame.sequence);
      if (sequences_.size() == 1) first_seen_.count_down();
      ended_ = frame.end;
      return absl::OkStatus();
    };
    result.on_resume = [this](const absl::Status& status) {
      if (resumes_++ > 0) return;
      reason_ = status;
      noticed_.count_down();
    };
    return result;
  }

  std::latch first_seen_{1};
  std::latch noticed_{1};
  int meshes_ = 0;
  int resumes_ = 0;
  bool ended_ = false;
  absl::Status reason_;
  std::vector<uint64_t> sequences_;
};

TEST_F(FrozenDaemonTest, IsNoticedByItsSilenceAndWatchedOn) {
  create(0.2, "x", false);
  auto watched = std::async(std::launch::async, [this] {
    return client::watch(client::Connection(daemon_->address()), request(), handlers());
  });
  first_seen_.wait();
  daemon_->signal(SIGSTOP);
  noticed_.wait();
  daemon_->signal(SIGCONT);
  ASSERT_TRUE(start("simulations/x").ok());
  const absl::Status status = watched.get();
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_THAT(std::string(reason_.message()), ::testing::HasSubstr("not even a heartbeat"));
  EXPECT_TRUE(ended_);
  EXPECT_EQ(sequences_.front(), 0u);
  EXPECT_EQ(sequences_.back(), 20u);
  EXPECT_TRUE(std::is_sorted(sequences_.begin(), sequences_.end()));
  EXPECT_EQ(std::adjacent_find(sequences_.begin(), sequences_.end()), sequences_.end()) << "none twice";
  EXPECT_EQ(meshes_, 1) << "it had them";
}

}  // namespace
}  // namespace lipofill::testing
