#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

namespace lipofill::server {

/// Ends the program with 1 when it is not destroyed within the timeout: a drain that hangs is cut
/// off. What was acknowledged is in the store by then; what was not, is lost. Checked by
/// tests/unit/server/ops/service_manager_test.cc.
class DrainGuard {
 public:
  explicit DrainGuard(double timeout_s);
  ~DrainGuard();
  DrainGuard(const DrainGuard&) = delete;
  DrainGuard& operator=(const DrainGuard&) = delete;

 private:
  void wait(double timeout_s);

  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::thread thread_;
};

}  // namespace lipofill::server
