#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {

/// A viewer on a connection of its own, which may act on a thread of its own.
class Spectator {
 public:
  Spectator(const std::string& server, const v1::WatchRequest& request);
  /// Leaves.
  ~Spectator();
  Spectator(const Spectator&) = delete;
  Spectator& operator=(const Spectator&) = delete;

  /// Waits for the next frame; false when the stream ends, with the last frame kept.
  bool next();
  const SeenFrame& frame() const { return frame_; }
  uint64_t sequence() const { return frame_.slice.sequence(); }
  bool saw_end() const { return frame_.slice.end(); }
  void await_sending() { watcher_.await_sending(); }
  /// The status of a stream that has ended.
  grpc::Status finish() { return watcher_.finish(); }
  grpc::Status acknowledge();

  void run(std::function<void(Spectator&)> act);
  void join() { thread_.join(); }

 private:
  const v1::WatchRequest request_;
  const std::shared_ptr<grpc::Channel> channel_;
  Watcher watcher_;
  SeenFrame frame_;
  std::thread thread_;
};

}  // namespace lipofill::testing
