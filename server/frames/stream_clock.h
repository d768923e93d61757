#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

namespace lipofill::server {

/// When a stream sends a heartbeat, and when it must end. It asks for one alarm at a time, to be
/// woken then.
///
/// Checked by tests/unit/server/frames/stream_clock_test.cc.
class StreamClock {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  /// The time at which the caller's token ends, and the stream with it.
  void set_end(Time end) { end_ = end; }
  bool is_over(Time now) const { return now >= end_; }

  /// A heartbeat is due where nothing was sent for so long.
  void begin(Clock::duration heartbeat, Time now) { heartbeat_ = heartbeat, last_sent_ = now; }
  void note_sent(Time now) { last_sent_ = now; }
  bool heartbeat_is_due(Time now) const { return now >= last_sent_ + heartbeat_; }

  /// The time of a new alarm, for the heartbeat or the end; nothing where one is set that has not
  /// come.
  std::optional<Time> set_alarm() {
    if (alarm_) return std::nullopt;
    alarm_ = std::min(last_sent_ + heartbeat_, end_);
    return alarm_;
  }
  /// The stream was woken: an alarm whose time has come is over.
  void note_woken(Time now) {
    if (alarm_ && *alarm_ <= now) alarm_.reset();
  }

 private:
  Clock::duration heartbeat_{};
  Time last_sent_{};
  Time end_ = Time::max();
  std::optional<Time> alarm_;
};

}  // namespace lipofill::server
