#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace lipofill::server {

/// A few threads for work too long for a thread that serves the network: building models, reading
/// scans, measuring distances.
class TaskPool {
 public:
  TaskPool(const std::string& name, int n_threads, size_t max_queued);
  ~TaskPool();

  /// Adds a task; false when too much waits already or the pool has stopped. The work must not
  /// throw. The label is for position().
  [[nodiscard]] bool run(std::function<void()> work, std::string label = "");
  /// Carries out what is queued (whoever waits for an answer gets one), then joins. Idempotent.
  void stop();
  /// Number of tasks that wait now.
  size_t queue_depth() const;
  /// Place in the queue of the work with this label: 1 is the next; 0 when it does not wait.
  size_t position(const std::string& label) const;
  size_t max_queued() const { return max_queued_; }

 private:
  void work();

  const size_t max_queued_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  struct Entry {
    std::function<void()> work;
    std::string label;
  };
  std::deque<Entry> queue_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace lipofill::server
