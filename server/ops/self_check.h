#pragma once

#include <atomic>
#include <chrono>
#include <functional>

#include "absl/status/status.h"
#include "server/ops/periodic.h"

namespace lipofill::server {

/// Checks every so often whether the daemon can still be reached, on a thread of its own, and tells
/// when that changes. Checked by tests/unit/server/ops/self_check_test.cc and
/// tests/integration/security/descriptors_test.cc.
class SelfCheck {
 public:
  /// @param check   takes bounded time; OK for a daemon that is reached
  /// @param change  is told of the first failure after a success, and of the next success
  SelfCheck(std::chrono::duration<double> period, std::function<absl::Status()> check,
            std::function<void(bool)> change);

  bool is_good() const { return is_good_; }

 private:
  void look();

  const std::function<absl::Status()> check_;
  const std::function<void(bool)> change_;
  std::atomic<bool> is_good_ = true;
  const Periodic periodic_;  ///< last: its thread uses the others
};

}  // namespace lipofill::server
