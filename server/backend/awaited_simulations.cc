#include "server/backend/awaited_simulations.h"

#include <algorithm>

namespace lipofill::server {
namespace {

constexpr std::chrono::seconds kFirstDelay{1};
constexpr std::chrono::seconds kLongestDelay{60};
constexpr uint32_t kMostDoublings = 6;

std::chrono::seconds delay_after(uint32_t attempts) {
  const uint32_t doublings = std::min(attempts - 1, kMostDoublings);
  return std::min(kFirstDelay * (1 << doublings), kLongestDelay);
}

}  // namespace

std::chrono::duration<double> Awaited::delay(Clock::time_point now) const {
  return std::max(std::chrono::duration<double>(next_attempt - now), std::chrono::duration<double>(0.0));
}

void AwaitedSimulations::note(const std::string& id, const std::string& waiting_for, uint64_t until_step,
                              Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  Awaited& awaited = awaited_[id];
  awaited.waiting_for = waiting_for;
  awaited.until_step = until_step;
  awaited.next_attempt = now + delay_after(++awaited.attempts);
}

void AwaitedSimulations::forget(const std::string& id) {
  const std::lock_guard lock(mutex_);
  awaited_.erase(id);
}

std::optional<Awaited> AwaitedSimulations::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = awaited_.find(id);
  return found == awaited_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::string> AwaitedSimulations::due(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<Clock::time_point, std::string>> due;
  for (const auto& [id, awaited] : awaited_) {
    if (awaited.next_attempt <= now) due.emplace_back(awaited.next_attempt, id);
  }
  std::sort(due.begin(), due.end());
  std::vector<std::string> ids;
  for (const auto& [time, id] : due) ids.push_back(id);
  return ids;
}

size_t AwaitedSimulations::size() const {
  const std::lock_guard lock(mutex_);
  return awaited_.size();
}

}  // namespace lipofill::server
