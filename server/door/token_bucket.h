#pragma once

#include <algorithm>
#include <chrono>

namespace lipofill::server {

/// Allows so many of something a second, and a stock of them at once. Not thread-safe. Checked by
/// tests/unit/server/door/frame_meter_test.cc.
class TokenBucket {
 public:
  using Clock = std::chrono::steady_clock;

  TokenBucket(double per_second, double most) : per_second_(per_second), most_(most), left_(most) {}

  /// Takes one; false when there is none.
  bool take(Clock::time_point now) {
    fill(now);
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }
  /// The moment when there is one again.
  Clock::time_point next(Clock::time_point now) {
    fill(now);
    const double seconds = std::max(0.0, 1.0 - left_) / per_second_;
    return now + std::chrono::ceil<Clock::duration>(std::chrono::duration<double>(seconds));
  }

 private:
  void fill(Clock::time_point now) {
    if (now <= filled_) return;
    const double seconds = filled_ == Clock::time_point{} ? 0.0 : std::chrono::duration<double>(now - filled_).count();
    left_ = std::min(most_, left_ + seconds * per_second_);
    filled_ = now;
  }

  const double per_second_;
  const double most_;
  double left_;
  Clock::time_point filled_{};
};

}  // namespace lipofill::server
