#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace lipofill::server {

/// Calls a function every period, on a thread of its own, until it is destroyed; the destructor
/// waits for a call under way. Checked by tests/unit/server/ops/self_check_test.cc.
class Periodic {
 public:
  /// @param name  of the thread, at most 15 characters
  Periodic(const std::string& name, std::chrono::duration<double> period, std::function<void()> work);
  ~Periodic();
  Periodic(const Periodic&) = delete;
  Periodic& operator=(const Periodic&) = delete;

 private:
  void run(const std::string& name);

  const std::chrono::duration<double> period_;
  const std::function<void()> work_;
  std::mutex mutex_;
  std::condition_variable stop_;
  bool is_stopped_ = false;
  std::thread thread_;
};

}  // namespace lipofill::server
