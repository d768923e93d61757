#include "server/entry/live_calls.h"

#include <grpc/grpc.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/sessions/memory.h"

namespace lipofill::server {
namespace {

std::string caller_key(const Principal& principal) {
  return absl::StrCat(principal.scope.tenant, "/", principal.subject);
}

void end_call(grpc_call* call, const absl::Status& status) {
  ::grpc_call_cancel_with_status(call, static_cast<grpc_status_code>(status.code()),
                                 std::string(status.message()).c_str(), nullptr);
}

absl::Status too_much(uint64_t bytes, uint64_t most) {
  return absl::ResourceExhaustedError(absl::StrCat("answers that were asked for and not read would take ", bytes,
                                                   " bytes, may take ", most, "; read them before you ask for more"));
}

}  // namespace

uint64_t LiveCalls::add(grpc_call* call, const Principal& principal) {
  const std::lock_guard lock(mutex_);
  calls_.emplace(next_, Live{call, principal, 0, {}});
  return next_++;
}

void LiveCalls::give_back(Live& live) {
  if (live.bytes == 0) return;
  const auto counted = bytes_of_.find(caller_key(live.principal));
  counted->second -= live.bytes;
  if (counted->second == 0) bytes_of_.erase(counted);
  bytes_ -= live.bytes;
  live.bytes = 0;
}

void LiveCalls::remove(uint64_t number) {
  const std::lock_guard lock(mutex_);
  const auto found = calls_.find(number);
  if (found == calls_.end()) return;
  give_back(found->second);
  calls_.erase(found);
}

absl::Status LiveCalls::begin_answer(uint64_t number, uint64_t bytes) {
  std::unique_lock lock(mutex_);
  const auto found = calls_.find(number);
  if (found == calls_.end() || bytes == 0) return absl::OkStatus();
  Live& live = found->second;
  give_back(live);
  uint64_t& of_caller = bytes_of_[caller_key(live.principal)];
  absl::Status room;
  if (of_caller + bytes > bounds_.bytes_of_caller) room = too_much(of_caller + bytes, bounds_.bytes_of_caller);
  if (bytes_ + bytes > bounds_.bytes) room = too_much(bytes_ + bytes, bounds_.bytes);
  if (room.ok()) {
    live.bytes = bytes;
    live.since = Clock::now();
    of_caller += bytes;
    bytes_ += bytes;
    return room;
  }
  if (of_caller == 0) bytes_of_.erase(caller_key(live.principal));
  grpc_call* call = live.call;
  has_refused_ = true;
  lock.unlock();
  end_call(call, room);  // its watcher, who asks, holds it
  return room;
}

void LiveCalls::end_answer(uint64_t number) {
  const std::lock_guard lock(mutex_);
  if (const auto found = calls_.find(number); found != calls_.end()) give_back(found->second);
}

// Calls are ended outside of the lock, for that may end them on this thread, and with them remove()
// be called.
void LiveCalls::sweep(const std::function<absl::Status(const Principal&)>& check, Clock::time_point now) {
  std::vector<std::pair<grpc_call*, absl::Status>> ended;
  bool is_full = false;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [number, live] : calls_) {
      absl::Status status = check(live.principal);
      if (status.ok() && live.bytes > 0 && now - live.since > bounds_.unread) {
        status = absl::ResourceExhaustedError("the answer was not read in time; ask for it again");
      }
      if (status.ok()) continue;
      ::grpc_call_ref(live.call);
      ended.emplace_back(live.call, status);
    }
    is_full = std::exchange(has_refused_, false);
  }
  for (const auto& [call, status] : ended) {
    end_call(call, status);
    ::grpc_call_unref(call);
  }
  if (is_full || !ended.empty()) give_memory_back();
}

uint64_t LiveCalls::unread_bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace lipofill::server
