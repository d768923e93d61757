#include "server/rpc/courier.h"

#include "server/sessions/thread_name.h"

namespace lipofill::server {

Courier::Courier() : thread_([this] { work(); }) {}

Courier::~Courier() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Courier::wake(std::weak_ptr<Stream> stream) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(stream));
  }
  changed_.notify_one();
}

void Courier::work() {
  name_this_thread("courier");
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (stopping_) return;
    const std::weak_ptr<Stream> next = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    if (const auto stream = next.lock(); stream != nullptr) stream->deliver();
    lock.lock();
  }
}

}  // namespace lipofill::server
