#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "absl/status/status.h"

namespace lipofill::server {

/// The frames on their way to a client that acknowledges them, at most so many at once.
///
/// Checked by tests/unit/server/sessions/acknowledgements_test.cc.
class Acknowledgements {
 public:
  /// @param most  frames on their way; 0: no bound, and none is counted
  explicit Acknowledgements(size_t most) : most_(most) {}

  bool must_wait() const { return most_ > 0 && on_their_way_.size() >= most_; }
  size_t on_their_way() const { return on_their_way_.size(); }
  void note_sent(uint64_t epoch, uint64_t sequence);
  /// The client has taken the frame of this sequence and all before it. INVALID_ARGUMENT for one
  /// that was not sent.
  absl::Status acknowledge(uint64_t epoch, uint64_t sequence);
  /// Takes note that what is on its way is of a stretch that was left: no answer is waited for.
  void rewind() { on_their_way_.clear(); }

 private:
  const size_t most_;
  std::deque<uint64_t> on_their_way_;  ///< sequences
  uint64_t sent_epoch_ = 0;
  uint64_t sent_sequence_ = 0;
};

}  // namespace lipofill::server
