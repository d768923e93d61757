#include "server/store/tenures.h"

#include <ctime>

namespace lipofill::server {

LeaseClock::time_point LeaseClock::now() {
  timespec time{};
  ::clock_gettime(CLOCK_BOOTTIME, &time);
  return time_point(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

void Tenures::note(const std::string& simulation, uint64_t epoch) {
  const std::lock_guard lock(mutex_);
  epochs_[simulation] = epoch;
}

void Tenures::forget(const std::string& simulation) {
  const std::lock_guard lock(mutex_);
  epochs_.erase(simulation);
}

void Tenures::forget(const std::string& simulation, uint64_t epoch) {
  const std::lock_guard lock(mutex_);
  const auto found = epochs_.find(simulation);
  if (found != epochs_.end() && found->second == epoch) epochs_.erase(found);
}

std::optional<uint64_t> Tenures::epoch_of(const std::string& simulation) const {
  const std::lock_guard lock(mutex_);
  const auto found = epochs_.find(simulation);
  return found == epochs_.end() ? std::nullopt : std::optional(found->second);
}

std::map<std::string, uint64_t> Tenures::all() const {
  const std::lock_guard lock(mutex_);
  return epochs_;
}

}  // namespace lipofill::server
