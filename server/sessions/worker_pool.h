#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/sessions/admission_queue.h"

namespace lipofill::server {

/// A fixed number of threads that let tasks take turns. Tasks come in groups (tenants). The next
/// turn goes to the group that has had the least time so far, and in it to the task that has had
/// the least: a group with ten tasks gets no more of the threads than one with a single task, and
/// tasks with long turns and tasks with short ones get the same share, so that a long simulation
/// cannot starve a short one. At most `max_active` tasks share the threads; others wait in a queue
/// (AdmissionQueue), which is fair between groups too, until one of those wants no more turns. A
/// task is on one thread at a time. Checked by tests/unit/server/sessions/worker_pool_test.cc.
class WorkerPool {
 public:
  using Clock = std::chrono::steady_clock;

  /// The wish of a task after its turn: nothing, another turn at once, or one later.
  struct Next {
    enum Kind { kNothing, kAgain, kLater } kind = kNothing;
    Clock::time_point when = {};  ///< kLater
  };

  class Task {
   public:
    virtual ~Task() = default;
    /// Takes a turn; must not throw.
    virtual Next take_turn() = 0;
  };

  explicit WorkerPool(int n_workers, size_t max_active = std::numeric_limits<size_t>::max());
  ~WorkerPool();

  /// Schedules a task. The caller makes sure that the pool does not have it already.
  void schedule(std::shared_ptr<Task> task, const std::string& group = "");
  /// The same for a task whose turns are few and short, and that somebody waits for: it does not
  /// wait in the queue, and shares the threads beside the `max_active`.
  void schedule_at_once(std::shared_ptr<Task> task, const std::string& group = "");
  /// Place in the queue, as things stand: 1 is the next; 0: it does not wait in it.
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
  /// Tasks of a group that wait for a turn, by time used, then by when they came.
  using Ready = std::map<std::pair<Clock::duration, uint64_t>, std::shared_ptr<Task>>;

  /// Tasks that share the threads as one. Turns at hand count as far as they have gone, so that
  /// several threads do not all turn to the same group.
  struct Group {
    /// Brings `used` up to date.
    void count_turns_at_hand(Clock::time_point now);

    Ready ready;
    Clock::duration used{};  ///< until `counted_until`
    Clock::time_point counted_until;
    int n_turns = 0;               ///< at hand
    size_t n_tasks = 0;            ///< that share the threads
    Clock::duration least_used{};  ///< of the task whose turn was last
  };
  using Groups = std::map<std::string, Group>;

  /// A task that shares the threads, and the time it has had of them since it does. One that comes
  /// anew begins with that of the task of its group whose turn was last: it is neither ahead of the
  /// others nor behind.
  struct Active {
    std::shared_ptr<Task> task;
    Groups::iterator group;
    Clock::duration used;
  };

  void work(int index);
  void make_ready(Active active, Clock::time_point now);
  void admit(std::shared_ptr<Task> task, const std::string& group, Clock::time_point now);
  void admit_waiting(Clock::time_point now);
  void move_due_tasks(Clock::time_point now);
  bool any_ready() const;
  Active take_next(Clock::time_point now);
  void put_back(Active active, Clock::duration turn, const Next& next, Clock::time_point now);
  void let_go(Groups::iterator group);

  const int n_workers_;
  const size_t max_active_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  AdmissionQueue<std::shared_ptr<Task>> waiting_;
  Groups groups_;  ///< of the tasks that share the threads
  std::multimap<Clock::time_point, Active> later_;
  size_t n_active_ = 0;
  uint64_t n_made_ready_ = 0;
  Clock::duration least_used_{};  ///< of the group whose turn was last
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace lipofill::server
