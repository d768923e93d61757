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
  using WallTime = std::chrono::system_clock::time_point;

  /// The time at which the caller's token ends, and the stream with it: by the steady clock, and by
  /// the clock of the wall, which may be set to a later time meanwhile. Whichever comes first
  /// counts.
  void set_end(Time end, WallTime wall_end) { end_ = end, wall_end_ = wall_end; }
  bool is_over(Time now, WallTime wall_now) const { return now >= end_ || wall_now >= wall_end_; }

  /// A heartbeat is due where nothing was sent for so long.
  void begin(Clock::duration heartbeat, Time now) { heartbeat_ = heartbeat, last_sent_ = now; }
  void note_sent(Time now) { last_sent_ = now; }
  bool heartbeat_is_due(Time now) const { return now >= last_sent_ + heartbeat_; }

  /// The time of a new alarm, for the heartbeat, the end, or a look at the clock of the wall;
  /// nothing where one is set that has not come.
  std::optional<Time> set_alarm(Time now) {
    if (alarm_) return std::nullopt;
    alarm_ = std::min(last_sent_ + heartbeat_, end_);
    if (wall_end_ != WallTime::max()) alarm_ = std::min(*alarm_, now + kLook);
    return alarm_;
  }
  /// An alarm at this time takes the place of the one that is set.
  void replace_alarm(Time time) { alarm_ = time; }
  /// The stream was woken: an alarm whose time has come is over.
  void note_woken(Time now) {
    if (alarm_ && *alarm_ <= now) alarm_.reset();
  }

 private:
  /// A stream that ends with a token looks at the clock of the wall this often.
  static constexpr std::chrono::seconds kLook{5};

  Clock::duration heartbeat_{};
  Time last_sent_{};
  Time end_ = Time::max();
  WallTime wall_end_ = WallTime::max();
  std::optional<Time> alarm_;
};

}  // namespace lipofill::server
