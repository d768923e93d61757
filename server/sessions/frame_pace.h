#pragma once

#include <chrono>

namespace lipofill::server {

/// When a viewer is due its next frame: by an interval of simulated time, and by a rate on the
/// clock.
///
/// Checked by tests/unit/server/sessions/frame_pace_test.cc.
class FramePace {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param interval_s    simulated time between frames; 0: every step
  /// @param max_rate_hz   frames a second of the clock; 0: no bound
  /// @param shares_rate   its moments are those of all who share the rate, so that one frame is
  ///                      made and encoded for all
  FramePace(double interval_s, double max_rate_hz, bool shares_rate)
      : interval_s_(interval_s), shares_rate_(shares_rate), max_rate_hz_(max_rate_hz) {}

  /// True when a frame of this simulated time is due. At rest the clock does not count: no later
  /// frame may come.
  bool is_due(double time_s, bool at_rest, Clock::time_point now) const;
  void set_max_rate(double max_rate_hz) { max_rate_hz_ = max_rate_hz; }
  /// A frame of this simulated time was offered.
  void note_offered(double time_s);
  /// A frame was taken, to be sent.
  void note_taken(Clock::time_point now);
  /// The simulated time of what comes may be earlier than that of what came.
  void rewind() { next_due_s_ = 0.0; }

 private:
  Clock::time_point find_next_due(Clock::time_point now) const;

  const double interval_s_;
  const bool shares_rate_;
  double max_rate_hz_;
  double next_due_s_ = 0.0;
  Clock::time_point next_due_{};  ///< by max_rate_hz_
};

}  // namespace lipofill::server
