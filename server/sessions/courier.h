#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace lipofill::server {

/// One thread that starts the writes of streams which have something new: encoding and network stay
/// off the threads that compute. It takes all that waits at once, so that a thread with a frame for
/// many viewers is not held up by the writes to the first of them. Checked by
/// tests/unit/server/sessions/courier_test.cc.
class Courier {
 public:
  using Clock = std::chrono::steady_clock;

  class Stream {
   public:
    virtual ~Stream() = default;
    virtual void deliver() = 0;
  };

  Courier();
  ~Courier();

  /// Calls deliver() soon. A stream that is gone by then is left out.
  void wake(std::weak_ptr<Stream> stream);
  /// Calls deliver() at that time. A stream has one such time: another takes its place.
  void wake_at(std::weak_ptr<Stream> stream, Clock::time_point time);
  /// Forgets the time of a stream that has ended.
  void forget(const std::weak_ptr<Stream>& stream);

 private:
  void work();
  bool await_streams(std::vector<std::weak_ptr<Stream>>& streams);
  void take_due_alarms();
  Clock::time_point next_alarm() const;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::weak_ptr<Stream>> waiting_;
  std::map<std::weak_ptr<Stream>, Clock::time_point, std::owner_less<>> alarms_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace lipofill::server
