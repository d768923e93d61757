#include "server/frames/watch_stream.h"

#include <algorithm>
#include <array>
#include <exception>

#include "server/security/refusals.h"
#include "server/wire/status_mapping.h"

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

bool WatchStream::begin(std::shared_ptr<Viewer> viewer, Courier::Clock::duration heartbeat,
                        std::function<void()> on_done) {
  std::unique_lock lock(mutex_);
  if (finished_) return false;
  self_ = shared_from_this();
  on_done_ = std::move(on_done);
  viewer_ = std::move(viewer);
  heartbeat_ = heartbeat;
  last_sent_ = Courier::Clock::now();
  advance(std::move(lock));
  return true;
}

void WatchStream::hold() {
  self_ = shared_from_this();
}

bool WatchStream::has_ended() {
  const std::lock_guard lock(mutex_);
  return finished_;
}

void WatchStream::begin_kept(const std::shared_ptr<const KeptMessages>& kept) {
  std::unique_lock lock(mutex_);
  if (finished_) return;
  self_ = shared_from_this();
  queue_meshes({kept, &kept->meshes});
  queue_frame({kept, &kept->frame}, 0);
  end_ = absl::OkStatus();
  advance(std::move(lock));
}

void WatchStream::begin_failed(const absl::Status& status) {
  std::unique_lock lock(mutex_);
  if (finished_) return;
  self_ = shared_from_this();
  end_ = status;
  advance(std::move(lock));
}

void WatchStream::wake() {
  if (!woken_.exchange(true)) courier_.wake(weak_from_this());
}

void WatchStream::deliver() {
  woken_ = false;
  std::unique_lock lock(mutex_);
  if (alarm_ && *alarm_ <= Courier::Clock::now()) alarm_.reset();
  advance(std::move(lock));
}

void WatchStream::OnWriteDone(bool ok) {
  std::unique_lock lock(mutex_);
  writing_ = false;
  last_sent_ = Courier::Clock::now();
  at_hand_.Clear();
  if (!ok) cancelled_ = true;
  advance(std::move(lock));
}

void WatchStream::OnCancel() {
  std::unique_lock lock(mutex_);
  cancelled_ = true;
  advance(std::move(lock));
}

void WatchStream::OnDone() {
  courier_.forget(weak_from_this());
  if (on_done_ != nullptr) on_done_();
  place_.reset();
  const std::shared_ptr<WatchStream> last = std::move(self_);
}

// One write is under way at a time, and Finish comes once: after the last write, also when the client has gone.
void WatchStream::advance(std::unique_lock<std::mutex> lock) {
  if (writing_ || finished_) return;
  if (cancelled_) {
    end_ = absl::CancelledError("the viewer has gone");
    outgoing_.clear();
  } else if (!end_ && Courier::Clock::now() >= expires_) {
    end_ = token_expired();
    outgoing_.clear();
  } else if (outgoing_.empty() && !end_) {
    try {
      fetch();
      if (outgoing_.empty() && !end_) queue_due_heartbeat();
    } catch (const std::exception& error) {
      end_ = absl::ResourceExhaustedError(error.what());
    }
  }
  if (!outgoing_.empty()) {
    at_hand_.Swap(&outgoing_.front());
    outgoing_.pop_front();
    writing_ = true;
    lock.unlock();
    StartWrite(&at_hand_);
  } else if (end_) {
    finished_ = true;
    const grpc::Status status = to_grpc_status(*end_);
    lock.unlock();
    Finish(status);
  }
}

void WatchStream::fetch() {
  while (outgoing_.empty() && !end_ && viewer_ != nullptr) {
    ToSend next = viewer_->take();
    if (auto* meshes = std::get_if<TopologyToSend>(&next)) {
      queue_meshes(encode_shared(*meshes->topology, viewer_->selection().meshes));
    } else if (auto* frame = std::get_if<FrameToSend>(&next)) {
      queue_frame(encode_shared(*frame->frame, viewer_->selection(), topology_hash_), frame->skipped);
      sent_epoch_ = frame->frame->epoch;
      sent_sequence_ = frame->frame->sequence;
    } else if (auto* end = std::get_if<EndOfStream>(&next)) {
      end_ = end->status;
    } else {
      return;
    }
  }
}

/// Queues a heartbeat if one is due. Otherwise the courier looks again when it will be, or when the
/// stream must end.
void WatchStream::queue_due_heartbeat() {
  if (viewer_ == nullptr) return;
  const Courier::Clock::time_point due = last_sent_ + heartbeat_;
  if (Courier::Clock::now() < due) {
    if (alarm_) return;
    alarm_ = std::min(due, expires_);
    courier_.wake_at(weak_from_this(), *alarm_);
    return;
  }
  v1::WatchResponse response;
  response.mutable_heartbeat()->set_epoch(sent_epoch_);
  response.mutable_heartbeat()->set_sequence(sent_sequence_);
  response.mutable_heartbeat()->set_unacknowledged_frames(static_cast<uint32_t>(viewer_->unacknowledged()));
  const grpc::Slice slice(response.SerializeAsString());
  outgoing_.emplace_back(&slice, 1);
}

void WatchStream::queue_meshes(const std::shared_ptr<const EncodedMessages>& meshes) {
  topology_hash_ = meshes->topology_hash;
  if (topology_hash_ == known_topology_hash_) return;
  for (const std::string& message : meshes->messages) {
    const grpc::Slice slice = share(meshes, message);
    outgoing_.emplace_back(&slice, 1);
  }
}

void WatchStream::queue_frame(const std::shared_ptr<const EncodedMessages>& frame, uint64_t skipped) {
  metrics_.count_frame_sent(skipped);
  for (const std::string& body : frame->messages) {
    const std::array<grpc::Slice, 2> slices = {grpc::Slice(frame_header(body.size(), skipped)), share(frame, body)};
    outgoing_.emplace_back(slices.data(), slices.size());
  }
}

}  // namespace lipofill::server
