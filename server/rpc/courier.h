#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace lipofill::server {

/// One thread that starts the writes of streams which have something new: encoding and network stay off the threads
/// that compute. It takes all that waits at once, so that a thread with a frame for many viewers is not held up by the
/// writes to the first of them. Checked by tests/unit/server/courier_test.cc.
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
  std::vector<std::weak_ptr<Stream>> waiting_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace lipofill::server
