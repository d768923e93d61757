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
  bool is_first = false;
  {
    const std::lock_guard lock(mutex_);
    is_first = waiting_.empty();
    waiting_.push_back(std::move(stream));
  }
  if (is_first) changed_.notify_one();
}

void Courier::work() {
  name_this_thread("courier");
  std::vector<std::weak_ptr<Stream>> taken;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
      if (stopping_) return;
      taken.swap(waiting_);
    }
    for (const std::weak_ptr<Stream>& next : taken) {
      if (const auto stream = next.lock(); stream != nullptr) stream->deliver();
    }
    taken.clear();
  }
}

}  // namespace lipofill::server
