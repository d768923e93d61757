#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "server/store/records.h"

namespace lipofill::server {

/// A long-running operation as it is now.
struct OperationView {
  std::string id;
  std::string target;
  std::string tenant;
  bool done = false;
  double progress = 0.0;
  std::string stage;
  absl::Status error;            ///< once done, when it failed
  std::string response_message;  ///< once done, when it did not: a google.protobuf.Any
  int64_t create_time_us = 0;
};

/// The operations of this run of the daemon; they do not outlive it, what they made does. Of those
/// that are done the last thousand are remembered. Checked by
/// tests/unit/server/sessions/operations_test.cc.
class Operations {
 public:
  using Clock = std::chrono::steady_clock;
  using Reply = std::function<void(absl::StatusOr<OperationView>)>;

  Operations();
  ~Operations();

  struct Started {
    OperationView operation;
    bool is_new = true;  ///< false: an equal request started it before
  };
  /// Starts an operation. INVALID_ARGUMENT for a request id that was used for another request,
  /// UNAVAILABLE once stop() was called.
  absl::StatusOr<Started> start(const std::string& target, const RequestKey& request);
  /// Adds one that is done already: a request repeated after a restart.
  OperationView add_done(const std::string& target, const RequestKey& request, std::string response_message);

  /// Reports the progress of the work; false asks the work to stop.
  bool report(const std::string& id, double progress, const std::string& stage);
  void finish(const std::string& id, absl::StatusOr<std::string> response_message);
  /// Forgets one whose work never began.
  void drop(const std::string& id);

  absl::StatusOr<OperationView> get(const std::string& id) const;
  absl::StatusOr<Owner> owner_of(const std::string& id) const;
  /// Lists the operations within the scope.
  std::vector<OperationView> list(const Scope& scope, const Page& page) const;
  /// The reply comes when it is done, its progress is not `seen_progress`, or the timeout has
  /// passed. On any thread.
  void wait(const std::string& id, std::chrono::milliseconds timeout, std::optional<double> seen_progress, Reply reply);
  absl::Status cancel(const std::string& id);
  /// Cancels what is under way and answers all who wait with UNAVAILABLE. Idempotent.
  void stop();

 private:
  struct Entry {
    OperationView view;
    RequestKey request;
    bool cancelled = false;
  };
  struct Waiter {
    std::string id;
    Clock::time_point deadline;
    std::optional<double> seen_progress;
    Reply reply;
  };
  struct Answer {
    Reply reply;
    OperationView view;
  };

  Entry* find_request(const RequestKey& request);
  Entry& add(const std::string& target, const RequestKey& request);
  /// Takes out the waiters whose time has come.
  std::vector<Answer> take_answers(Clock::time_point now);
  void notify(std::unique_lock<std::mutex> lock);
  void forget_oldest();
  void serve_timeouts();

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, Entry> entries_;
  std::list<std::string> done_;  ///< oldest first
  std::list<Waiter> waiters_;
  bool stopping_ = false;
  std::thread timer_;
};

}  // namespace lipofill::server
