#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "tests/integration/chaos/chaos_daemon.h"

namespace lipofill::testing {

/// Watches one simulation after the other, takes broken streams up again where they were, and
/// checks that epochs never fall and that sequence numbers rise by one within an epoch.
class Spectator {
 public:
  /// @param present  names the simulation to watch; empty: none yet
  Spectator(const ChaosDaemon& daemon, std::function<std::string()> present)
      : daemon_(daemon), present_(std::move(present)) {}

  void run(const std::atomic<bool>& stop);
  uint64_t frames() const { return frames_; }
  uint64_t epochs() const { return epochs_; }

 private:
  /// Until it ends, is gone, or `stop`.
  void watch(const std::string& name, const std::atomic<bool>& stop);

  const ChaosDaemon& daemon_;
  const std::function<std::string()> present_;
  uint64_t frames_ = 0;
  uint64_t epochs_ = 0;
};

}  // namespace lipofill::testing
