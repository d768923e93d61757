#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace lipofill::server {

/// A fixed number of threads that let tasks take short turns, round robin: a task that wants to go on queues up behind
/// all others, so a long simulation cannot starve a short one. A task is on one thread at a time. Checked by
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

  explicit WorkerPool(int n_workers);
  ~WorkerPool();

  /// Whoever calls makes sure that the task is not queued already.
  void schedule(std::shared_ptr<Task> task);
  /// Lets the turns at hand end, drops what is queued. Idempotent.
  void stop();
  /// Tasks that wait for a turn now.
  size_t queue_depth() const;
  int n_workers() const { return n_workers_; }

 private:
  void work(int index);
  void move_due_tasks(Clock::time_point now);

  const int n_workers_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Task>> ready_;
  std::multimap<Clock::time_point, std::shared_ptr<Task>> later_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace lipofill::server
