#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

namespace lipofill::server {

/// One thread that starts the writes of streams which have something new: encoding and network stay off the threads
/// that compute.
class Courier {
 public:
  class Stream {
   public:
    virtual ~Stream() = default;
    virtual void deliver() = 0;
  };

  Courier();
  ~Courier();

  /// Calls deliver() soon. A stream that is gone by then is left out.
  void wake(std::weak_ptr<Stream> stream);

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::weak_ptr<Stream>> queue_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace lipofill::server
