#include "server/entry/live_calls.h"

#include <grpc/grpc.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/sessions/memory.h"
#include "server/sessions/shortage.h"
#include "server/sessions/shown_bytes.h"

namespace lipofill::server {
namespace {

/// A viewer that takes so long for a message is slow.
constexpr std::chrono::seconds kSlow{1};
/// Memory is given back to the system when half of so many calls have ended.
constexpr size_t kManyCalls = 512;
/// So many sweeps give memory back after much was let go of: what a call sent, or asked and was
/// refused, is freed some time after the call is removed, on a busy machine seconds after.
constexpr int kSweepsAfter = 5;

void end_call(grpc_call* call, const absl::Status& status) {
  ::grpc_call_cancel_with_status(call, static_cast<grpc_status_code>(status.code()),
                                 std::string(status.message()).c_str(), nullptr);
}

absl::Status too_many_calls(const char* whose, size_t most) {
  constexpr double kRetryDelayS = 2.0;
  return shortage("TOO_MANY_CALLS", kRetryDelayS,
                  absl::StrCat("there are more calls ", whose, " under way than may be, ", most, "; end some first"));
}

}  // namespace

LiveCalls::LiveCalls(const CallBounds& bounds)
    : bounds_(bounds),
      messages_(bounds.messages, "requests and unread answers"),
      streams_(bounds.streams, "streams that were not read to their ends") {}

uint64_t LiveCalls::add(grpc_call* call, const Principal& principal, bool shows) {
  const std::lock_guard lock(mutex_);
  Live live;
  live.call = call;
  live.principal = principal;
  live.caller = absl::StrCat(principal.scope.tenant, "/", principal.subject);
  live.shows = shows;
  ++calls_of_[live.caller];
  calls_.emplace(next_, std::move(live));
  most_calls_ = std::max(most_calls_, calls_.size());
  return next_++;
}

LiveCalls::Live* LiveCalls::find(uint64_t number) {
  const auto found = calls_.find(number);
  return found == calls_.end() ? nullptr : &found->second;
}

void LiveCalls::end_sent(Live& live) {
  messages_.give_back(live.caller, std::exchange(live.sent, 0));
  live.waits = false;
}

void LiveCalls::remove(uint64_t number) {
  constexpr uint64_t kMuch = 1 << 16;
  const std::lock_guard lock(mutex_);
  Live* live = find(number);
  if (live == nullptr) return;
  const bool held_much = live->sent + live->kept > kMuch || live->request > 16 * kMuch || live->is_refused;
  if (held_much || (live->shows && live->waits)) sweeps_to_trim_ = kSweepsAfter;
  end_sent(*live);
  messages_.give_back(live->caller, live->request);
  streams_.give_back(live->caller, live->kept);
  if (const auto own = calls_of_.find(live->caller); --own->second == 0) calls_of_.erase(own);
  calls_.erase(number);
  if (most_calls_ < kManyCalls || calls_.size() > most_calls_ / 2) return;
  sweeps_to_trim_ = kSweepsAfter;
  most_calls_ = calls_.size();
}

absl::Status LiveCalls::check_number_of_calls(uint64_t number) {
  grpc_call* call = nullptr;
  absl::Status room;
  {
    const std::lock_guard lock(mutex_);
    const Live* live = find(number);
    if (live == nullptr) return room;
    call = live->call;
    const size_t own = calls_of_.find(live->caller)->second;
    if (own > bounds_.calls_of_caller) room = too_many_calls("of yours", bounds_.calls_of_caller);
    if (calls_.size() > bounds_.calls) room = too_many_calls("in all", bounds_.calls);
  }
  if (!room.ok()) end_call(call, room);  // its watcher, who asks, holds it
  return room;
}

absl::Status LiveCalls::keep_request(uint64_t number, uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  Live* live = find(number);
  if (live == nullptr) return absl::OkStatus();
  messages_.give_back(live->caller, std::exchange(live->request, 0));
  const absl::Status room = messages_.take(live->caller, bytes);
  if (room.ok()) live->request = bytes;
  live->is_refused = live->is_refused || !room.ok();
  return room;
}

absl::Status LiveCalls::keep_answers(uint64_t number, uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  Live* live = find(number);
  if (live == nullptr) return absl::OkStatus();
  const absl::Status room = streams_.take(live->caller, bytes);
  if (room.ok()) live->kept += bytes;
  return room;
}

// What is kept is let go of as it is sent (CallWatcher), but for what is on its way.
absl::Status LiveCalls::begin_answer(uint64_t number, uint64_t bytes) {
  std::unique_lock lock(mutex_);
  Live* live = find(number);
  if (live == nullptr || bytes == 0) return absl::OkStatus();
  end_sent(*live);
  live->waits = true;
  live->since = Clock::now();
  if (live->shows) return absl::OkStatus();
  const absl::Status room = messages_.take(live->caller, bytes);
  if (room.ok()) {
    live->sent = bytes;
    const uint64_t of_kept = std::min(live->kept, bytes);
    streams_.give_back(live->caller, of_kept);
    live->kept -= of_kept;
    return room;
  }
  live->is_refused = true;
  grpc_call* call = live->call;
  lock.unlock();
  end_call(call, room);  // its watcher, who asks, holds it
  return room;
}

void LiveCalls::end_answer(uint64_t number) {
  const std::lock_guard lock(mutex_);
  if (Live* live = find(number); live != nullptr) end_sent(*live);
}

absl::Status LiveCalls::check_live(const Live& live, Clock::time_point now) const {
  if (live.waits && !live.shows && now - live.since > bounds_.unread) {
    return absl::ResourceExhaustedError("the answer was not read in time; ask for it again");
  }
  return absl::OkStatus();
}

/// Ends half of the viewers that are slow: they hold frames that others have done with.
void LiveCalls::end_slowest_viewers(Clock::time_point now, Ended& ended) const {
  std::vector<const Live*> slow;
  for (const auto& [number, live] : calls_) {
    if (live.shows && live.waits && now - live.since > kSlow) slow.push_back(&live);
  }
  const auto half = slow.begin() + static_cast<std::ptrdiff_t>((slow.size() + 1) / 2);
  std::partial_sort(slow.begin(), half, slow.end(), [](const Live* a, const Live* b) { return a->since < b->since; });
  for (auto viewer = slow.begin(); viewer != half; ++viewer) {
    ::grpc_call_ref((*viewer)->call);
    ended.emplace_back((*viewer)->call, too_many_shown(bounds_.shown));
  }
}

// Calls are ended outside of the lock, for that may end them on this thread, and with them remove()
// be called.
void LiveCalls::sweep(const std::function<absl::Status(const Principal&)>& check, Clock::time_point now) {
  Ended ended;
  bool gives_back = false;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [number, live] : calls_) {
      absl::Status status = check(live.principal);
      status.Update(check_live(live, now));
      if (status.ok()) continue;
      ::grpc_call_ref(live.call);
      ended.emplace_back(live.call, status);
    }
    if (shown_bytes() > bounds_.shown / 4 * 3) end_slowest_viewers(now, ended);
    if (!ended.empty()) sweeps_to_trim_ = kSweepsAfter;
    gives_back = sweeps_to_trim_ > 0;
    sweeps_to_trim_ -= gives_back ? 1 : 0;
  }
  for (const auto& [call, status] : ended) {
    end_call(call, status);
    ::grpc_call_unref(call);
  }
  if (gives_back) give_memory_back();
}

uint64_t LiveCalls::bytes() const {
  const std::lock_guard lock(mutex_);
  return messages_.bytes() + streams_.bytes();
}

}  // namespace lipofill::server
