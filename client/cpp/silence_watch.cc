#include "client/cpp/silence_watch.h"

#include <utility>

namespace lipofill::client {

SilenceWatch::SilenceWatch(std::chrono::milliseconds limit, std::function<void()> on_silence)
    : limit_(limit), on_silence_(std::move(on_silence)), thread_([this](const std::stop_token& stop) { look(stop); }) {}

void SilenceWatch::begin_wait() {
  const std::lock_guard lock(mutex_);
  waiting_since_ = Clock::now();
}

void SilenceWatch::end_wait() {
  const std::lock_guard lock(mutex_);
  waiting_since_.reset();
}

bool SilenceWatch::was_silent() const {
  const std::lock_guard lock(mutex_);
  return was_silent_;
}

/// Looks twice in the time allowed, so that a wait that begins and ends wakes nobody.
void SilenceWatch::look(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    changed_.wait_for(lock, stop, limit_ / 2, [&stop] { return stop.stop_requested(); });
    if (!waiting_since_ || Clock::now() - *waiting_since_ < limit_) continue;
    was_silent_ = true;
    lock.unlock();
    on_silence_();
    return;
  }
}

}  // namespace lipofill::client
