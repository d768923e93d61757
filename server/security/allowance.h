#pragma once

#include <chrono>
#include <mutex>

namespace lipofill::server {

/// Allows so many of something in each period. Thread-safe. Checked by
/// tests/unit/server/security/authenticator_test.cc.
class Allowance {
 public:
  using Clock = std::chrono::steady_clock;

  Allowance(int most, Clock::duration period) : most_(most), period_(period) {}

  /// Takes one; false when the period has had its share.
  bool take(Clock::time_point now = Clock::now()) {
    const std::lock_guard lock(mutex_);
    if (now >= end_) {
      end_ = now + period_;
      taken_ = 0;
    }
    return ++taken_ <= most_;
  }

 private:
  const int most_;
  const Clock::duration period_;
  std::mutex mutex_;
  Clock::time_point end_{};
  int taken_ = 0;
};

}  // namespace lipofill::server
