#pragma once

#include <cstdint>
#include <deque>
#include <memory>

#include "absl/status/status.h"
#include "server/sessions/frame.h"
#include "server/sessions/shown_bytes.h"

namespace lipofill::server {

enum class Delivery { kLatest, kEvery };

/// A frame that is to be sent.
struct FrameToSend {
  std::shared_ptr<const Frame> frame;
  uint64_t skipped = 0;  ///< frames left out before this one
};

/// The frames that wait for a viewer. kLatest keeps one, and the preview beside it: a newer one
/// takes its place and the skipped one is counted. kEvery keeps all up to a number of bytes.
///
/// Checked by tests/unit/server/sessions/frame_queue_test.cc.
class FrameQueue {
 public:
  /// @param max_bytes  of the fields that wait, kEvery
  /// @param max_shown  of all viewers, shown_bytes(): beyond it none may have a frame wait behind
  /// another, kEvery
  FrameQueue(Delivery delivery, size_t max_bytes, uint64_t max_shown = UINT64_MAX)
      : delivery_(delivery), max_bytes_(max_bytes), max_shown_(max_shown) {}

  bool empty() const { return frames_.empty(); }
  const Frame& front() const { return *frames_.front(); }
  /// Adds a frame. RESOURCE_EXHAUSTED, and nothing waits any more, when the bytes would be more
  /// than the bound; a single frame may be larger.
  absl::Status push(std::shared_ptr<const Frame> frame);
  /// Takes the first frame, which there must be.
  FrameToSend pop();
  void clear();

 private:
  void skip_waiting();
  void count() { counted_ = ShownBytes(bytes_); }

  const Delivery delivery_;
  const size_t max_bytes_;
  const uint64_t max_shown_;
  std::deque<std::shared_ptr<const Frame>> frames_;
  size_t bytes_ = 0;
  ShownBytes counted_;  ///< bytes_
  uint64_t skipped_ = 0;
};

}  // namespace lipofill::server
