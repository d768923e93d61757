#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

namespace lipofill::client {

/// Notices that something waited for does not come: calls `on_silence` once, on a thread of its
/// own, when a wait lasts longer than `limit`. What is done between waits may take any time.
/// Checked by tests/unit/client/silence_watch_test.cc.
class SilenceWatch {
 public:
  SilenceWatch(std::chrono::milliseconds limit, std::function<void()> on_silence);

  void begin_wait();
  void end_wait();
  /// True when on_silence was called.
  bool was_silent() const;

 private:
  using Clock = std::chrono::steady_clock;
  void look(const std::stop_token& stop);

  const std::chrono::milliseconds limit_;
  const std::function<void()> on_silence_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<Clock::time_point> waiting_since_;
  bool was_silent_ = false;
  std::jthread thread_;
};

}  // namespace lipofill::client
