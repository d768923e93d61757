#include "server/sessions/worker_pool.h"

#include <algorithm>
#include <string>

#include "server/sessions/thread_name.h"

namespace lipofill::server {

WorkerPool::WorkerPool(int n_workers) : n_workers_(std::max(1, n_workers)) {
  for (int i = 0; i < n_workers_; ++i) threads_.emplace_back([this, i] { work(i); });
}

WorkerPool::~WorkerPool() {
  stop();
}

void WorkerPool::schedule(std::shared_ptr<Task> task) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    ready_.push_back(std::move(task));
  }
  changed_.notify_one();
}

size_t WorkerPool::queue_depth() const {
  const std::lock_guard lock(mutex_);
  return ready_.size();
}

void WorkerPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    ready_.clear();
    later_.clear();
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

void WorkerPool::move_due_tasks(Clock::time_point now) {
  while (!later_.empty() && later_.begin()->first <= now) {
    ready_.push_back(std::move(later_.begin()->second));
    later_.erase(later_.begin());
  }
}

void WorkerPool::work(int index) {
  name_this_thread("worker/" + std::to_string(index));
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    move_due_tasks(Clock::now());
    if (ready_.empty()) {
      if (later_.empty()) {
        changed_.wait(lock);
      } else {
        const Clock::time_point due = later_.begin()->first;
        changed_.wait_until(lock, due);
      }
      continue;
    }
    std::shared_ptr<Task> task = std::move(ready_.front());
    ready_.pop_front();
    lock.unlock();
    const Next next = task->take_turn();
    lock.lock();
    if (stopping_ || next.kind == Next::kNothing) continue;
    if (next.kind == Next::kAgain) {
      ready_.push_back(std::move(task));
    } else {
      later_.emplace(next.when, std::move(task));
    }
    changed_.notify_one();
  }
}

}  // namespace lipofill::server
