#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace lipofill::server {

/// A clock that never steps, and goes on while the machine sleeps.
struct LeaseClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<LeaseClock, duration>;
  static constexpr bool is_steady = true;
  static time_point now();
};

/// The simulations that this daemon owns, each with the epoch in which it took it, and until when
/// its lease on them lasts. The database decides who owns what (Ownership); this is what the daemon
/// knows of it. Thread-safe. Checked by tests/unit/server/store/ownership_test.cc.
class Tenures {
 public:
  /// @param daemon  the number of this daemon among those of the database
  explicit Tenures(int64_t daemon) : daemon_(daemon) {}

  int64_t daemon() const { return daemon_; }
  void note(const std::string& simulation, uint64_t epoch);
  void forget(const std::string& simulation);
  /// Forgets it unless it was taken again since.
  void forget(const std::string& simulation, uint64_t epoch);
  std::optional<uint64_t> epoch_of(const std::string& simulation) const;
  std::map<std::string, uint64_t> all() const;

  void extend(LeaseClock::time_point end) { end_ = end; }
  bool is_held(LeaseClock::time_point now = LeaseClock::now()) const { return now < end_.load(); }

 private:
  const int64_t daemon_;
  std::atomic<LeaseClock::time_point> end_ = LeaseClock::time_point{};
  mutable std::mutex mutex_;
  std::map<std::string, uint64_t> epochs_;
};

}  // namespace lipofill::server
