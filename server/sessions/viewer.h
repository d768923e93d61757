#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "server/sessions/acknowledgements.h"
#include "server/sessions/frame.h"
#include "server/sessions/frame_pace.h"
#include "server/sessions/frame_queue.h"
#include "server/sessions/selection.h"

namespace lipofill::server {

struct ViewerOptions {
  Delivery delivery = Delivery::kLatest;
  /// Meshes empty: those of the fields, or without these "skin" and every film.
  Selection selection;
  double interval_s = 0.0;   ///< simulated time between frames; 0: every step
  double max_rate_hz = 0.0;  ///< frames a second of the clock, kLatest; 0: no bound
  bool shares_rate = false;  ///< max_rate_hz is what the session gives it
  uint64_t seen_epoch = 0;
  uint64_t seen_sequence = 0;
  size_t max_queued_bytes = size_t{64} << 20;  ///< kEvery
  uint64_t max_shown_bytes = UINT64_MAX;       ///< of all viewers (shown_bytes.h)
  size_t max_unacknowledged = 0;               ///< frames on their way; 0: no bound
};

struct TopologyToSend {
  std::shared_ptr<const Topology> topology;
};
/// The stream ends with this status.
struct EndOfStream {
  absl::Status status;
};
using ToSend = std::variant<std::monostate, TopologyToSend, FrameToSend, EndOfStream>;

/// A viewer holds what one watcher has yet to be sent: meshes, frames, the end. The session puts
/// frames in and never waits; the stream takes them out as fast as its client reads.
///
/// A queue that overflows (FrameQueue) ends the stream. Where the client acknowledges frames, none
/// but the last is taken while `max_unacknowledged` are on their way: what is taken after an
/// acknowledgement is as new as that.
/// Checked by tests/unit/server/sessions/viewer_test.cc and
/// tests/unit/server/sessions/viewer_options_test.cc.
class Viewer {
 public:
  using Clock = std::chrono::steady_clock;

  /// `wake` is called, on any thread and without a lock of this class, when there is something to
  /// take; it must not block.
  Viewer(ViewerOptions options, std::function<void()> wake);

  // These are called by the session.
  void show_topology(std::shared_ptr<const Topology> topology);
  /// True when a frame of this simulated time is due by the interval and by the clock. At rest the
  /// clock does not count: no later frame may come.
  bool wants(double time_s, bool at_rest = false, Clock::time_point now = Clock::now()) const;
  void offer(std::shared_ptr<const Frame> frame);
  /// The simulated time of what comes may be earlier than that of what came.
  void rewind();
  /// Ends the stream after what is queued when OK, at once when not.
  void close(absl::Status status);
  bool closed() const;
  /// The meshes it is shown. INVALID_ARGUMENT naming one that there is not.
  absl::Status choose_meshes(const Topology& topology);
  /// Checks, once the meshes are known, that all fields asked for are among those of a frame, by
  /// full name.
  absl::Status check_fields(const std::vector<std::string>& known) const;
  const Selection& selection() const { return selection_; }
  bool shares_rate() const { return options_.shares_rate; }
  uint64_t max_shown_bytes() const { return options_.max_shown_bytes; }
  void set_max_rate(double max_rate_hz);

  /// Notes that the client has taken the frame of this sequence and all before it. INVALID_ARGUMENT
  /// for one that was not sent.
  absl::Status acknowledge(uint64_t epoch, uint64_t sequence);

  // These are called by the stream.
  size_t unacknowledged() const;
  ToSend take(Clock::time_point now = Clock::now());

 private:
  bool was_seen(const Frame& frame) const;
  FrameToSend take_frame(Clock::time_point now);
  bool must_wait() const;

  const ViewerOptions options_;
  const std::function<void()> wake_;
  Selection selection_;

  mutable std::mutex mutex_;
  std::shared_ptr<const Topology> topology_;
  FrameQueue frames_;
  FramePace pace_;
  Acknowledgements acknowledgements_;
  std::optional<uint64_t> offered_sequence_;
  std::optional<absl::Status> end_;
  bool end_taken_ = false;
};

}  // namespace lipofill::server
