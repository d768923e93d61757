#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "server/sessions/frame.h"

namespace lipofill::server {

enum class Delivery { kLatest, kEvery };

struct ViewerOptions {
  Delivery delivery = Delivery::kLatest;
  std::vector<std::string> meshes;  ///< empty: "skin" and every film
  double interval_s = 0.0;          ///< simulated time between frames; 0: every step
  uint64_t seen_epoch = 0;
  uint64_t seen_sequence = 0;
  size_t max_queued_bytes = size_t{64} << 20;  ///< kEvery
};

struct TopologyToSend {
  std::shared_ptr<const Topology> topology;
};
struct FrameToSend {
  std::shared_ptr<const Frame> frame;
  uint64_t skipped = 0;  ///< frames left out before this one
};
/// The stream ends with this status.
struct EndOfStream {
  absl::Status status;
};
using ToSend = std::variant<std::monostate, TopologyToSend, FrameToSend, EndOfStream>;

/// What one watcher has yet to be sent. The session puts in and never waits; the stream takes out as fast as its client
/// reads.
///
/// kLatest keeps one frame, and the preview beside it: a newer one takes its place and the skipped one is counted.
/// kEvery keeps all up to a number of bytes; one frame more ends the stream with RESOURCE_EXHAUSTED. Checked by
/// tests/unit/server/viewer_test.cc.
class Viewer {
 public:
  /// `wake` is called, on any thread and without a lock of this class, when there is something to take; it must not
  /// block.
  Viewer(ViewerOptions options, std::function<void()> wake);

  // For the session.
  void show_topology(std::shared_ptr<const Topology> topology);
  /// Whether a frame of this simulated time is due at the interval.
  bool wants(double time_s) const;
  void offer(std::shared_ptr<const Frame> frame);
  /// Ends the stream after what is queued when OK, at once when not.
  void close(absl::Status status);
  bool closed() const;
  /// The meshes it is shown: those asked for, or "skin" and the films. INVALID_ARGUMENT naming one that there is not.
  absl::Status choose_meshes(const Topology& topology);
  const std::vector<std::string>& meshes() const { return meshes_; }

  // For the stream.
  ToSend take();

 private:
  bool was_seen(const Frame& frame) const;
  void skip_waiting_frames();
  void queue_frame(std::shared_ptr<const Frame> frame);

  const ViewerOptions options_;
  const std::function<void()> wake_;
  std::vector<std::string> meshes_;

  mutable std::mutex mutex_;
  std::shared_ptr<const Topology> topology_;
  std::deque<std::shared_ptr<const Frame>> frames_;
  size_t queued_bytes_ = 0;
  uint64_t skipped_ = 0;
  double next_due_s_ = 0.0;
  std::optional<absl::Status> end_;
  bool end_taken_ = false;
};

}  // namespace lipofill::server
