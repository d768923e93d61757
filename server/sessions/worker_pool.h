#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace lipofill::server {

/// A fixed number of threads that let tasks take turns. The next turn goes to the task that has had the least time so
/// far, so that tasks with long turns and tasks with short ones get the same share of the threads, and a long
/// simulation cannot starve a short one. At most `max_active` tasks share the threads; others wait in a queue, first
/// come, first served, until one of those wants no more turns. A task is on one thread at a time. Checked by
/// tests/unit/server/worker_pool_test.cc.
class WorkerPool {
 public:
  using Clock = std::chrono::steady_clock;

  /// What a task wants after its turn.
  struct Next {
    enum Kind { kNothing, kAgain, kLater } kind = kNothing;
    Clock::time_point when = {};  ///< kLater
  };

  class Task {
   public:
    virtual ~Task() = default;
    /// Must not throw.
    virtual Next take_turn() = 0;
  };

  explicit WorkerPool(int n_workers, size_t max_active = std::numeric_limits<size_t>::max());
  ~WorkerPool();

  /// Whoever calls makes sure that the pool does not have the task already.
  void schedule(std::shared_ptr<Task> task);
  /// Place in the queue: 1 is the next; 0: it does not wait in it.
  size_t queue_position(const Task& task) const;
  /// Takes a task out of the queue; false when it does not wait in it.
  [[nodiscard]] bool withdraw(const Task& task);
  /// Lets the turns at hand end, drops what is queued. Idempotent.
  void stop();
  /// Tasks that share the threads and wait for a turn now.
  size_t queue_depth() const;
  /// Tasks that wait until others want no more turns.
  size_t n_waiting() const;
  int n_workers() const { return n_workers_; }

 private:
  /// A task that shares the threads, and the time it has had of them since it does. One that comes anew begins with
  /// that of the task whose turn was last: it is neither ahead of the others nor behind.
  struct Active {
    std::shared_ptr<Task> task;
    Clock::duration used;
  };
  /// By time used, then by when it came.
  using Ready = std::map<std::pair<Clock::duration, uint64_t>, std::shared_ptr<Task>>;

  void work(int index);
  void make_ready(Active active);
  void admit_waiting();
  void move_due_tasks(Clock::time_point now);
  Active take_next();
  void put_back(Active active, Clock::duration turn, const Next& next);

  const int n_workers_;
  const size_t max_active_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Ready ready_;
  std::multimap<Clock::time_point, Active> later_;
  std::deque<std::shared_ptr<Task>> waiting_;
  size_t n_active_ = 0;
  uint64_t n_made_ready_ = 0;
  Clock::duration least_used_{};  ///< of the task whose turn was last
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace lipofill::server
