#include "server/sessions/worker_pool.h"

#include <algorithm>
#include <string>

#include "server/sessions/thread_name.h"

namespace lipofill::server {

WorkerPool::WorkerPool(int n_workers, size_t max_active)
    : n_workers_(std::max(1, n_workers)), max_active_(std::max<size_t>(1, max_active)) {
  for (int i = 0; i < n_workers_; ++i) threads_.emplace_back([this, i] { work(i); });
}

WorkerPool::~WorkerPool() {
  stop();
}

void WorkerPool::schedule(std::shared_ptr<Task> task) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    waiting_.push_back(std::move(task));
    admit_waiting();
  }
  changed_.notify_one();
}

size_t WorkerPool::queue_position(const Task& task) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& t) { return t.get() == &task; });
  return found == waiting_.end() ? 0 : static_cast<size_t>(found - waiting_.begin()) + 1;
}

bool WorkerPool::withdraw(const Task& task) {
  std::shared_ptr<Task> last;  // let go of outside the lock
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& t) { return t.get() == &task; });
  if (found == waiting_.end()) return false;
  last = std::move(*found);
  waiting_.erase(found);
  return true;
}

size_t WorkerPool::queue_depth() const {
  const std::lock_guard lock(mutex_);
  return ready_.size();
}

size_t WorkerPool::n_waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

void WorkerPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    ready_.clear();
    later_.clear();
    waiting_.clear();
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

void WorkerPool::make_ready(Active active) {
  ready_.emplace(std::pair(active.used, n_made_ready_++), std::move(active.task));
}

void WorkerPool::admit_waiting() {
  for (; n_active_ < max_active_ && !waiting_.empty(); ++n_active_) {
    make_ready({std::move(waiting_.front()), least_used_});
    waiting_.pop_front();
  }
}

/// Time that a task let pass is not owed to it.
void WorkerPool::move_due_tasks(Clock::time_point now) {
  while (!later_.empty() && later_.begin()->first <= now) {
    Active active = std::move(later_.begin()->second);
    later_.erase(later_.begin());
    active.used = std::max(active.used, least_used_);
    make_ready(std::move(active));
  }
}

WorkerPool::Active WorkerPool::take_next() {
  const auto first = ready_.begin();
  Active next{std::move(first->second), first->first.first};
  ready_.erase(first);
  least_used_ = std::max(least_used_, next.used);
  return next;
}

void WorkerPool::put_back(Active active, Clock::duration turn, const Next& next) {
  active.used += turn;
  if (next.kind == Next::kAgain) return make_ready(std::move(active));
  if (next.kind == Next::kLater) {
    later_.emplace(next.when, std::move(active));
    return;
  }
  --n_active_;
  admit_waiting();
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
    Active active = take_next();
    lock.unlock();
    const Clock::time_point begin = Clock::now();
    const Next next = active.task->take_turn();
    const Clock::duration turn = Clock::now() - begin;
    if (next.kind == Next::kNothing) active.task = nullptr;  // perhaps its end, which needs no lock
    lock.lock();
    if (stopping_) continue;
    put_back(std::move(active), turn, next);
    changed_.notify_one();
  }
}

}  // namespace lipofill::server
