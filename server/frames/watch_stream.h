#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "server/backend/kept_result.h"
#include "server/frames/outgoing_messages.h"
#include "server/frames/stream_clock.h"
#include "server/ops/viewer_metrics.h"
#include "server/sessions/courier.h"
#include "server/sessions/viewer.h"

namespace lipofill::server {

/// The server's side of one Watch: takes what its viewer holds and writes it, one message at a
/// time, as fast as the client reads, or a heartbeat (StreamClock) where there is nothing.
///
/// It keeps itself alive from begin() until gRPC is done with it.
class WatchStream : public grpc::ServerWriteReactor<grpc::ByteBuffer>,
                    public Courier::Stream,
                    public std::enable_shared_from_this<WatchStream> {
 public:
  /// `place` is let go of when gRPC is done with the stream.
  WatchStream(Courier& courier, ViewerMetrics& metrics, std::string known_topology_hash,
              std::shared_ptr<void> place = nullptr)
      : courier_(courier), place_(std::move(place)), outgoing_(metrics, std::move(known_topology_hash)) {}

  /// Sets the time at which the stream ends with UNAUTHENTICATED; to be called before it begins.
  void end_at(Courier::Clock::time_point time, StreamClock::WallTime wall_time) { clock_.set_end(time, wall_time); }

  /// A stream that shows what a session puts into the viewer, and a heartbeat where that was
  /// nothing for so long. `on_done` is called once, at the end. False, and nothing is shown, when
  /// the client left while it was held.
  [[nodiscard]] bool begin(std::shared_ptr<Viewer> viewer, Courier::Clock::duration heartbeat,
                           std::function<void()> on_done);
  /// Keeps it, for a begin that comes later from another thread.
  void hold();
  /// The client has left, or the stream has ended otherwise: a begin would show nothing.
  bool has_ended();
  /// A stream of messages that are all there.
  void begin_kept(const std::shared_ptr<const KeptMessages>& kept);
  /// A stream that ends at once.
  void begin_failed(const absl::Status& status);
  /// Is called for the viewer when there is something to take. Never blocks.
  void wake();

  void deliver() override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  void advance(std::unique_lock<std::mutex> lock);
  bool fetch();
  void send_due_heartbeat();
  void look_again_at(Courier::Clock::time_point time);

  Courier& courier_;
  std::shared_ptr<void> place_;
  std::shared_ptr<WatchStream> self_;
  std::function<void()> on_done_;
  std::atomic<bool> woken_ = false;

  std::mutex mutex_;
  std::shared_ptr<Viewer> viewer_;
  StreamClock clock_;
  OutgoingMessages outgoing_;
  grpc::ByteBuffer at_hand_;
  bool writing_ = false;
  bool cancelled_ = false;
  bool finished_ = false;
  std::optional<absl::Status> end_;
};

}  // namespace lipofill::server
