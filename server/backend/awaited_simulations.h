#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace lipofill::server {

/// A simulation that could not be brought back yet.
struct Awaited {
  using Clock = std::chrono::steady_clock;

  std::string waiting_for;
  uint64_t until_step = 0;  ///< where its last command took effect
  uint32_t attempts = 0;    ///< that were in vain
  Clock::time_point next_attempt = {};

  /// Time until the next attempt, 0 when it is due.
  std::chrono::duration<double> delay(Clock::time_point now = Clock::now()) const;
};

/// The simulations that could not be brought back yet, with what each waits for and when it is
/// tried again: after a second, then after twice as long each time, up to a minute. Thread-safe.
/// Checked by tests/unit/server/backend/awaited_simulations_test.cc.
class AwaitedSimulations {
 public:
  using Clock = Awaited::Clock;

  /// Notes an attempt that was in vain.
  void note(const std::string& id, const std::string& waiting_for, uint64_t until_step,
            Clock::time_point now = Clock::now());
  void forget(const std::string& id);
  std::optional<Awaited> find(const std::string& id) const;
  /// Those whose next attempt is due, the longest due first.
  std::vector<std::string> due(Clock::time_point now = Clock::now()) const;
  size_t size() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Awaited> awaited_;
};

}  // namespace lipofill::server
