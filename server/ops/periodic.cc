#include "server/ops/periodic.h"

#include <pthread.h>

namespace lipofill::server {

Periodic::Periodic(const std::string& name, std::chrono::duration<double> period, std::function<void()> work)
    : period_(period), work_(std::move(work)), thread_([this, name] { run(name); }) {}

Periodic::~Periodic() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  stop_.notify_all();
  thread_.join();
}

void Periodic::run(const std::string& name) {
  ::pthread_setname_np(::pthread_self(), name.c_str());
  std::unique_lock lock(mutex_);
  while (!stop_.wait_for(lock, period_, [this] { return is_stopped_; })) {
    lock.unlock();
    work_();
    lock.lock();
  }
}

}  // namespace lipofill::server
