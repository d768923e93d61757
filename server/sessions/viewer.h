#pragma once

#include <chrono>
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
#include "server/sessions/selection.h"

namespace lipofill::server {

enum class Delivery { kLatest, kEvery };

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
  size_t max_unacknowledged = 0;               ///< frames on their way; 0: no bound
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

/// Queue of what one watcher has yet to be sent. The session puts frames in and never waits; the
/// stream takes them out as fast as its client reads.
///
/// kLatest holds one frame, and the preview beside it: a newer one takes its place and the skipped one is counted.
/// kEvery holds all up to a number of bytes; one frame more ends the stream with RESOURCE_EXHAUSTED. Where the client
/// acknowledges frames, none but the last is taken while `max_unacknowledged` are on their way: what is taken after an
/// acknowledgement is as new as that. Checked by tests/unit/server/sessions/viewer_test.cc.
class Viewer {
 public:
  using Clock = std::chrono::steady_clock;

  /// `wake` is called, on any thread and without a lock of this class, when there is something to take; it must not
  /// block.
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
  void set_max_rate(double max_rate_hz);

  /// Notes that the client has taken the frame of this sequence and all before it. INVALID_ARGUMENT
  /// for one that was not sent.
  absl::Status acknowledge(uint64_t epoch, uint64_t sequence);

  // These are called by the stream.
  size_t unacknowledged() const;
  ToSend take(Clock::time_point now = Clock::now());

 private:
  bool was_seen(const Frame& frame) const;
  void skip_waiting_frames();
  void queue_frame(std::shared_ptr<const Frame> frame);
  FrameToSend take_frame(Clock::time_point now);
  /// The next moment a frame is due. It is the same for all viewers who share a rate, so that one
  /// frame is made and encoded for all.
  Clock::time_point find_next_due(Clock::time_point now) const;
  bool must_wait() const;

  const ViewerOptions options_;
  const std::function<void()> wake_;
  Selection selection_;

  mutable std::mutex mutex_;
  std::shared_ptr<const Topology> topology_;
  std::deque<std::shared_ptr<const Frame>> frames_;
  size_t queued_bytes_ = 0;
  uint64_t skipped_ = 0;
  double next_due_s_ = 0.0;
  double max_rate_hz_ = 0.0;
  Clock::time_point next_due_{};  ///< by max_rate_hz_
  std::optional<uint64_t> offered_sequence_;
  std::deque<uint64_t> unacknowledged_;  ///< sequences, where max_unacknowledged is set
  uint64_t sent_epoch_ = 0;
  uint64_t sent_sequence_ = 0;
  std::optional<absl::Status> end_;
  bool end_taken_ = false;
};

}  // namespace lipofill::server
