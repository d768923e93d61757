#include "server/frames/outgoing_messages.h"

#include <array>

namespace lipofill::server {
namespace {

/// A slice over bytes that others send too; it keeps them alive.
grpc::Slice share(const std::shared_ptr<const EncodedMessages>& encoded, const std::string& message) {
  using Owner = std::shared_ptr<const EncodedMessages>;
  return grpc::Slice(
      const_cast<char*>(message.data()), message.size(), [](void* owner) { delete static_cast<Owner*>(owner); },
      new Owner(encoded));
}

}  // namespace

void OutgoingMessages::add(const TopologyToSend& meshes, const Selection& selection) {
  add_meshes(encode_shared(*meshes.topology, selection.meshes));
}

void OutgoingMessages::add(const FrameToSend& frame, const Selection& selection) {
  add_frame(encode_shared(*frame.frame, selection, topology_hash_), frame.skipped);
  sent_epoch_ = frame.frame->epoch;
  sent_sequence_ = frame.frame->sequence;
}

void OutgoingMessages::add_encoded(const std::shared_ptr<const EncodedMessages>& meshes,
                                   const std::shared_ptr<const EncodedMessages>& frame) {
  add_meshes(meshes);
  add_frame(frame, 0);
}

void OutgoingMessages::add_meshes(const std::shared_ptr<const EncodedMessages>& meshes) {
  topology_hash_ = meshes->topology_hash;
  if (topology_hash_ == known_topology_hash_) return;
  for (const std::string& message : meshes->messages) {
    const grpc::Slice slice = share(meshes, message);
    waiting_.emplace_back(&slice, 1);
  }
}

void OutgoingMessages::add_frame(const std::shared_ptr<const EncodedMessages>& frame, uint64_t skipped) {
  metrics_.count_frame_sent(skipped);
  for (const std::string& body : frame->messages) {
    const std::array<grpc::Slice, 2> slices = {grpc::Slice(frame_header(body.size(), skipped)), share(frame, body)};
    waiting_.emplace_back(slices.data(), slices.size());
  }
}

void OutgoingMessages::add_heartbeat(size_t unacknowledged) {
  v1::WatchResponse response;
  response.mutable_heartbeat()->set_epoch(sent_epoch_);
  response.mutable_heartbeat()->set_sequence(sent_sequence_);
  response.mutable_heartbeat()->set_unacknowledged_frames(static_cast<uint32_t>(unacknowledged));
  const grpc::Slice slice(response.SerializeAsString());
  waiting_.emplace_back(&slice, 1);
}

void OutgoingMessages::take_next(grpc::ByteBuffer& message) {
  message.Swap(&waiting_.front());
  waiting_.pop_front();
}

}  // namespace lipofill::server
