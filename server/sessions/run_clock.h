#pragma once

#include <chrono>

namespace lipofill::server {

/// The clock of a simulation: how long it has run, and when its next step is due at the pace of one
/// simulated second a second. Time in a queue, at rest, or spent on a preview does not count; the
/// pace begins anew with every stretch.
///
/// Checked by tests/unit/server/sessions/run_clock_test.cc.
class RunClock {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  /// @param wall_s  what it has run before [s]
  explicit RunClock(double wall_s) : wall_before_s_(wall_s) {}

  bool runs() const { return runs_; }
  /// Begins a stretch at this simulated time [s].
  void begin(double simulated_s, Time now = Clock::now());
  void stop(Time now = Clock::now());
  /// Takes time out of the stretch at hand.
  void leave_out(Clock::duration spent) { since_ += spent; }
  /// Stands from now on, as one that has run for so long [s].
  void set_back(double wall_s);

  double wall_s(Time now = Clock::now()) const;
  /// When this simulated time comes, at the pace of the clock on the wall. The clock must run.
  Time due_time(double simulated_s) const;

 private:
  bool runs_ = false;
  Time since_;
  double since_simulated_s_ = 0.0;
  double wall_before_s_;
};

}  // namespace lipofill::server
