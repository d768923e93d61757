#pragma once

#include <atomic>
#include <chrono>

namespace lipofill::server {

/// The clock tells how long nobody has wanted anything of a session: whoever watches it or is about
/// to ask something holds it. Thread-safe and never waits. Checked by
/// tests/unit/server/sessions/idle_clock_test.cc.
class IdleClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// Something was asked now.
  void note_use() { last_use_ = Clock::now(); }
  void begin_watching() { ++watchers_; }
  void end_watching() { --watchers_, note_use(); }
  void hold() { ++holders_; }
  void let_go() { note_use(), --holders_; }

  int watchers() const { return watchers_; }
  bool is_held() const { return holders_ > 0; }
  /// Time since it was last wanted; 0 while it is.
  Clock::duration idle_time() const {
    return watchers_ == 0 && !is_held() ? Clock::now() - last_use_.load() : Clock::duration::zero();
  }

 private:
  std::atomic<int> watchers_ = 0;
  std::atomic<int> holders_ = 0;
  std::atomic<Clock::time_point> last_use_ = Clock::now();
};

}  // namespace lipofill::server
