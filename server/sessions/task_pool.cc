#include "server/sessions/task_pool.h"

#include <algorithm>

#include "server/sessions/thread_name.h"

namespace lipofill::server {

TaskPool::TaskPool(const std::string& name, int n_threads, size_t max_queued) : max_queued_(max_queued) {
  for (int i = 0; i < n_threads; ++i) {
    threads_.emplace_back([this, own = name + "/" + std::to_string(i)] {
      name_this_thread(own);
      work();
    });
  }
}

TaskPool::~TaskPool() {
  stop();
}

bool TaskPool::run(std::function<void()> work, std::string label) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_ || queue_.size() >= max_queued_) return false;
    queue_.push_back({std::move(work), std::move(label)});
  }
  changed_.notify_one();
  return true;
}

size_t TaskPool::queue_depth() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

size_t TaskPool::position(const std::string& label) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(queue_.begin(), queue_.end(), [&](const Entry& e) { return e.label == label; });
  return found == queue_.end() ? 0 : static_cast<size_t>(found - queue_.begin()) + 1;
}

void TaskPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

void TaskPool::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (queue_.empty()) return;
    std::function<void()> next = std::move(queue_.front().work);
    queue_.pop_front();
    lock.unlock();
    next();
    next = nullptr;
    lock.lock();
  }
}

}  // namespace lipofill::server
