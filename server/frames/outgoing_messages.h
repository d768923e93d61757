#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "server/ops/viewer_metrics.h"
#include "server/sessions/viewer.h"
#include "server/wire/frame_encoding.h"

namespace lipofill::server {

/// The messages of one Watch that wait to be written. They share their bytes with those of other
/// viewers of the same selection. For one thread at a time.
///
/// Checked by tests/unit/server/frames/outgoing_messages_test.cc.
class OutgoingMessages {
 public:
  /// @param known_topology_hash  of the meshes that the client has already; they are not sent again
  OutgoingMessages(ViewerMetrics& metrics, std::string known_topology_hash)
      : metrics_(metrics), known_topology_hash_(std::move(known_topology_hash)) {}

  bool empty() const { return waiting_.empty(); }
  void add(const TopologyToSend& meshes, const Selection& selection);
  void add(const FrameToSend& frame, const Selection& selection);
  /// Adds meshes and a frame that were encoded before.
  void add_encoded(const std::shared_ptr<const EncodedMessages>& meshes,
                   const std::shared_ptr<const EncodedMessages>& frame);
  /// Adds a sign of life, which repeats the epoch and the sequence of the last frame.
  void add_heartbeat(size_t unacknowledged);
  /// Moves the next message there; there must be one.
  void take_next(grpc::ByteBuffer& message);
  void clear() { waiting_.clear(); }

 private:
  void add_meshes(const std::shared_ptr<const EncodedMessages>& meshes);
  void add_frame(const std::shared_ptr<const EncodedMessages>& frame, uint64_t skipped);

  ViewerMetrics& metrics_;
  const std::string known_topology_hash_;
  std::string topology_hash_;
  uint64_t sent_epoch_ = 0;
  uint64_t sent_sequence_ = 0;
  std::deque<grpc::ByteBuffer> waiting_;
};

}  // namespace lipofill::server
