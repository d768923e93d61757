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

void WorkerPool::schedule(std::shared_ptr<Task> task, const std::string& group) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    waiting_.push(std::move(task), group);
    admit_waiting(Clock::now());
  }
  changed_.notify_one();
}

void WorkerPool::schedule_at_once(std::shared_ptr<Task> task, const std::string& group) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    admit(std::move(task), group, Clock::now());
  }
  changed_.notify_one();
}

size_t WorkerPool::queue_position(const Task& task) const {
  const std::lock_guard lock(mutex_);
  return waiting_.position([&](const auto& waiting) { return waiting.get() == &task; });
}

bool WorkerPool::withdraw(const Task& task) {
  std::shared_ptr<Task> last;  // let go of outside the lock
  const std::lock_guard lock(mutex_);
  return waiting_.withdraw([&](const auto& waiting) {
    if (waiting.get() != &task) return false;
    last = waiting;
    return true;
  });
}

size_t WorkerPool::queue_depth() const {
  const std::lock_guard lock(mutex_);
  size_t depth = 0;
  for (const auto& [name, group] : groups_) depth += group.ready.size();
  return depth;
}

size_t WorkerPool::n_waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

void WorkerPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    later_.clear();
    groups_.clear();
    waiting_ = {};
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

void WorkerPool::Group::count_turns_at_hand(Clock::time_point now) {
  used += n_turns * (now - counted_until);
  counted_until = now;
}

/// A group none of whose tasks waited for a turn, because it has just come, rested, or has fewer
/// tasks than there are threads, lacked nothing: it is level with the others from here on.
void WorkerPool::make_ready(Active active, Clock::time_point now) {
  Group& group = active.group->second;
  group.count_turns_at_hand(now);
  if (group.ready.empty()) group.used = std::max(group.used, least_used_);
  group.ready.emplace(std::pair(active.used, n_made_ready_++), std::move(active.task));
}

void WorkerPool::admit_waiting(Clock::time_point now) {
  while (n_active_ < max_active_ && !waiting_.empty()) {
    auto [task, group] = waiting_.admit();
    admit(std::move(task), group, now);
  }
}

void WorkerPool::admit(std::shared_ptr<Task> task, const std::string& name, Clock::time_point now) {
  const auto group = groups_.try_emplace(name).first;
  ++group->second.n_tasks;
  ++n_active_;
  make_ready({std::move(task), group, group->second.least_used}, now);
}

/// Time that a task let pass is not owed to it.
void WorkerPool::move_due_tasks(Clock::time_point now) {
  while (!later_.empty() && later_.begin()->first <= now) {
    Active active = std::move(later_.begin()->second);
    later_.erase(later_.begin());
    active.used = std::max(active.used, active.group->second.least_used);
    make_ready(std::move(active), now);
  }
}

bool WorkerPool::any_ready() const {
  return std::any_of(groups_.begin(), groups_.end(), [](const auto& group) { return !group.second.ready.empty(); });
}

WorkerPool::Active WorkerPool::take_next(Clock::time_point now) {
  auto least = groups_.end();
  for (auto group = groups_.begin(); group != groups_.end(); ++group) {
    group->second.count_turns_at_hand(now);
    if (group->second.ready.empty()) continue;
    if (least == groups_.end() || group->second.used < least->second.used) least = group;
  }
  Group& group = least->second;
  const auto first = group.ready.begin();
  Active next{std::move(first->second), least, first->first.first};
  group.ready.erase(first);
  group.least_used = std::max(group.least_used, next.used);
  ++group.n_turns;
  least_used_ = std::max(least_used_, group.used);
  return next;
}

void WorkerPool::put_back(Active active, Clock::duration turn, const Next& next, Clock::time_point now) {
  Group& group = active.group->second;
  group.count_turns_at_hand(now);
  --group.n_turns;
  active.used += turn;
  if (next.kind == Next::kAgain) return make_ready(std::move(active), now);
  if (next.kind == Next::kLater) {
    later_.emplace(next.when, std::move(active));
    return;
  }
  let_go(active.group);
  --n_active_;
  admit_waiting(now);
}

void WorkerPool::let_go(Groups::iterator group) {
  waiting_.leave(group->first);
  if (--group->second.n_tasks == 0) groups_.erase(group);
}

void WorkerPool::work(int index) {
  name_this_thread("worker/" + std::to_string(index));
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    move_due_tasks(Clock::now());
    if (!any_ready()) {
      if (later_.empty()) {
        changed_.wait(lock);
      } else {
        const Clock::time_point due = later_.begin()->first;
        changed_.wait_until(lock, due);
      }
      continue;
    }
    const Clock::time_point begin = Clock::now();
    Active active = take_next(begin);
    lock.unlock();
    const Next next = active.task->take_turn();
    const Clock::time_point end = Clock::now();
    if (next.kind == Next::kNothing) active.task = nullptr;  // perhaps its end, which needs no lock
    lock.lock();
    if (stopping_) continue;
    put_back(std::move(active), end - begin, next, Clock::now());
    changed_.notify_one();
  }
}

}  // namespace lipofill::server
