#include "server/ops/drain_guard.h"

#include <chrono>
#include <cstdlib>

#include "spdlog/spdlog.h"

namespace lipofill::server {

DrainGuard::DrainGuard(double timeout_s) : thread_([this, timeout_s] { wait(timeout_s); }) {}

DrainGuard::~DrainGuard() {
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void DrainGuard::wait(double timeout_s) {
  std::unique_lock lock(mutex_);
  if (changed_.wait_for(lock, std::chrono::duration<double>(timeout_s), [this] { return done_; })) return;
  spdlog::error("not drained within {} s: what is still under way is cut off", timeout_s);
  std::_Exit(1);
}

}  // namespace lipofill::server
