#include "tests/integration/chaos/spectator.h"

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {

void Spectator::run(const std::atomic<bool>& stop) {
  std::string last;
  while (!stop && !::testing::Test::HasFailure()) {
    const std::string name = present_();
    if (name.empty() || name == last) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      continue;
    }
    watch(name, stop);
    last = name;
  }
}

void Spectator::watch(const std::string& name, const std::atomic<bool>& stop) {
  v1::WatchRequest request;
  request.set_simulation(name);
  request.set_delivery(v1::WatchRequest::EVERY);
  uint64_t epoch = 0, sequence = 0;
  while (!stop) {
    const auto channel = daemon_.channel();
    request.set_seen_epoch(epoch);
    request.set_seen_sequence(sequence);
    Watcher watcher(*channel, request);
    SeenFrame frame;
    bool ended = false;
    while (!stop && watcher.next(frame)) {
      ++frames_;
      ASSERT_GE(frame.slice.epoch(), epoch) << name;
      if (frame.slice.epoch() > epoch) {
        ++epochs_;
      } else if (!frame.slice.end()) {
        ASSERT_GT(frame.slice.sequence(), sequence) << name << " in epoch " << epoch;
      }
      epoch = frame.slice.epoch();
      sequence = frame.slice.sequence();
      ended = frame.slice.end();
    }
    watcher.cancel();
    watcher.drain();
    const grpc::Status status = watcher.finish();
    if (ended || status.error_code() == grpc::StatusCode::NOT_FOUND) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
}

}  // namespace lipofill::testing
