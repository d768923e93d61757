#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "server/entry/caller_account.h"
#include "server/security/principal.h"

struct grpc_call;

namespace lipofill::server {

/// The bounds say how many calls may be under way, and what they may keep in memory.
struct CallBounds {
  /// The transport keeps some 20 kB of each. Callers who need not say who they are are one caller.
  size_t calls = 8192;
  size_t calls_of_caller = 2048;
  /// Requests, as they are in memory, and answers on their way. A message has at most 4 MiB.
  CallerAccount::Bounds messages{uint64_t{64} << 20, uint64_t{16} << 20};
  /// Answers of streams that were made as a whole, such as the mesh of a scan.
  CallerAccount::Bounds streams{uint64_t{256} << 20, uint64_t{32} << 20, true};
  std::chrono::steady_clock::duration unread = std::chrono::seconds(60);  ///< an answer waits no longer
  uint64_t shown = uint64_t{512} << 20;                                   ///< frames (shown_bytes.h)
};

/// The calls under way, who makes them, and what they keep in memory: a request until its call
/// ends, and an answer until its caller makes room for it, however long that takes and however many
/// there are. What is too much, waits too long, or is somebody's who is no longer known is ended
/// with its status. Thread-safe. Checked by tests/unit/server/entry/live_calls_test.cc,
/// tests/integration/security/unread_test.cc and tests/integration/security/revocation_test.cc.
class LiveCalls {
 public:
  using Clock = std::chrono::steady_clock;

  explicit LiveCalls(const CallBounds& bounds = {});

  /// Adds a call, which stays alive until it is removed; returns its number. What a call that
  /// `shows` frames sends is shared with others, and not counted as its caller's.
  uint64_t add(grpc_call* call, const Principal& principal, bool shows = false);
  void remove(uint64_t number);
  /// Ends a call that has just been added where it is one too many, of its caller or of all:
  /// RESOURCE_EXHAUSTED.
  absl::Status check_number_of_calls(uint64_t number);

  /// Counts the request of a call, or the present one of many. RESOURCE_EXHAUSTED without room.
  absl::Status keep_request(uint64_t number, uint64_t bytes);
  /// Counts answers of a stream that are there before the first is sent. RESOURCE_EXHAUSTED without
  /// room.
  absl::Status keep_answers(uint64_t number, uint64_t bytes);
  /// Counts an answer that is about to be sent, unless it is one of those that are kept.
  /// RESOURCE_EXHAUSTED, and the call is ended with that, where there is no room for it.
  absl::Status begin_answer(uint64_t number, uint64_t bytes);
  void end_answer(uint64_t number);

  /// Ends the calls whose answers wait too long, and those whose callers `check` refuses; where
  /// frames take more than they may, those that have waited longest for their viewers. Gives the
  /// memory of ended calls back to the system.
  void sweep(const std::function<absl::Status(const Principal&)>& check, Clock::time_point now = Clock::now());

  /// Everything that is counted.
  uint64_t bytes() const;

 private:
  struct Live {
    grpc_call* call = nullptr;
    Principal principal;
    std::string caller;
    bool shows = false;
    uint64_t request = 0;
    uint64_t kept = 0;  ///< of answers that have yet to be sent
    uint64_t sent = 0;  ///< of the answer that waits to be read
    bool waits = false;
    bool is_refused = false;  ///< for what it asked or was to be sent
    Clock::time_point since;  ///< it waits
  };
  using Ended = std::vector<std::pair<grpc_call*, absl::Status>>;
  // These must be called with the mutex held.
  Live* find(uint64_t number);
  void end_sent(Live& live);
  absl::Status check_live(const Live& live, Clock::time_point now) const;
  void end_slowest_viewers(Clock::time_point now, Ended& ended) const;

  const CallBounds bounds_;
  mutable std::mutex mutex_;
  std::map<uint64_t, Live> calls_;
  std::map<std::string, size_t> calls_of_;  ///< by caller
  size_t most_calls_ = 0;                   ///< since memory was given back
  CallerAccount messages_;
  CallerAccount streams_;
  uint64_t next_ = 1;
  int sweeps_to_trim_ = 0;  ///< so many more sweeps give memory back to the system
};

}  // namespace lipofill::server
