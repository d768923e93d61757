#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "server/security/principal.h"

struct grpc_call;

namespace lipofill::server {

/// What answers that are made and not yet read may take, as they go over the wire. gRPC keeps the
/// message that an answer was made from as well, which takes some four times as much.
struct AnswerBounds {
  uint64_t bytes = uint64_t{64} << 20;                                    ///< of all callers
  uint64_t bytes_of_caller = uint64_t{16} << 20;                          ///< of one
  std::chrono::steady_clock::duration unread = std::chrono::seconds(60);  ///< no longer than this
};

/// The calls under way, who makes them, and the answers of theirs that wait to be read: gRPC keeps
/// an answer in memory until its caller makes room for it, however long that takes and however many
/// there are. What is too much, waits too long, or is somebody's who is no longer known is ended
/// with its status. Thread-safe. Checked by tests/integration/security/flood_test.cc and
/// tests/integration/security/revocation_test.cc.
class LiveCalls {
 public:
  using Clock = std::chrono::steady_clock;

  explicit LiveCalls(AnswerBounds bounds = {}) : bounds_(bounds) {}

  /// Adds a call, which stays alive until it is removed; returns its number.
  uint64_t add(grpc_call* call, const Principal& principal);
  void remove(uint64_t number);

  /// Counts an answer that is about to be sent. RESOURCE_EXHAUSTED, and the call is ended with
  /// that, where there is no room for it.
  absl::Status begin_answer(uint64_t number, uint64_t bytes);
  void end_answer(uint64_t number);

  /// Ends the calls whose answers wait too long, and those whose callers `check` refuses; gives
  /// back the memory of answers that had no room since the last sweep.
  void sweep(const std::function<absl::Status(const Principal&)>& check, Clock::time_point now = Clock::now());

  uint64_t unread_bytes() const;

 private:
  struct Live {
    grpc_call* call = nullptr;
    Principal principal;
    uint64_t bytes = 0;  ///< of its answer that waits
    Clock::time_point since;
  };
  void give_back(Live& live);

  const AnswerBounds bounds_;
  mutable std::mutex mutex_;
  std::map<uint64_t, Live> calls_;
  std::map<std::string, uint64_t> bytes_of_;  ///< by caller
  uint64_t bytes_ = 0;
  uint64_t next_ = 1;
  bool has_refused_ = false;  ///< since the last sweep
};

}  // namespace lipofill::server
