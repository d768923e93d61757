#include "server/sessions/courier.h"

#include <algorithm>

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

void Courier::wake_at(std::weak_ptr<Stream> stream, Clock::time_point time) {
  {
    const std::lock_guard lock(mutex_);
    alarms_[std::move(stream)] = time;
  }
  changed_.notify_one();
}

void Courier::forget(const std::weak_ptr<Stream>& stream) {
  const std::lock_guard lock(mutex_);
  alarms_.erase(stream);
}

void Courier::work() {
  name_this_thread("courier");
  std::vector<std::weak_ptr<Stream>> taken;
  while (await_streams(taken)) {
    for (const std::weak_ptr<Stream>& next : taken) {
      if (const auto stream = next.lock(); stream != nullptr) stream->deliver();
    }
    taken.clear();
  }
}

/// Waits for work; false when it is to stop.
bool Courier::await_streams(std::vector<std::weak_ptr<Stream>>& streams) {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    take_due_alarms();
    if (!waiting_.empty()) {
      streams.swap(waiting_);
      return true;
    }
    if (alarms_.empty()) {
      changed_.wait(lock);
    } else {
      changed_.wait_until(lock, next_alarm());
    }
  }
  return false;
}

void Courier::take_due_alarms() {
  const Clock::time_point now = Clock::now();
  for (auto alarm = alarms_.begin(); alarm != alarms_.end();) {
    if (alarm->second > now) {
      ++alarm;
      continue;
    }
    waiting_.push_back(alarm->first);
    alarm = alarms_.erase(alarm);
  }
}

Courier::Clock::time_point Courier::next_alarm() const {
  const auto earlier = [](const auto& a, const auto& b) { return a.second < b.second; };
  return std::min_element(alarms_.begin(), alarms_.end(), earlier)->second;
}

}  // namespace lipofill::server
