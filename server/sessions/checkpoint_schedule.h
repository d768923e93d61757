#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace lipofill::server {

/// When a session keeps its state by itself as it runs: at intervals, which grow where keeping is
/// slow, so that it takes less than a hundredth of the run. After a start of the daemon intervals
/// are short and double each time, and keeping may take a tenth: where daemons die again and again,
/// each gets a little further than the one before. Checked by
/// tests/unit/server/sessions/checkpoint_schedule_test.cc.
class CheckpointSchedule {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  /// @param interval_s  0: never
  /// @param step        of the state that was kept last, if there is one
  CheckpointSchedule(double interval_s, std::optional<uint64_t> step) : interval_s_(interval_s), kept_step_(step) {}

  bool is_on() const { return interval_s_ > 0.0; }
  /// The first interval begins, when it has not yet.
  void begin(Time now = Clock::now());
  /// The first of the short intervals begins.
  void begin_soon(Time now = Clock::now());
  bool is_due(Time now = Clock::now()) const { return is_on() && due_ && now >= *due_; }
  /// The next interval begins, after keeping the state, or failing to, took this time.
  void begin_next(Time began, Time ended = Clock::now());

  void note_kept(uint64_t step) { kept_step_ = step; }
  /// The step of the state that was kept last.
  std::optional<uint64_t> kept_step() const { return kept_step_; }

 private:
  Clock::duration interval() const;

  const double interval_s_;
  std::optional<Clock::duration> soon_;  ///< the short interval at hand
  std::optional<Time> due_;
  std::optional<uint64_t> kept_step_;
};

}  // namespace lipofill::server
