#include "server/frames/watch_stream.h"

#include <chrono>
#include <exception>

#include "server/security/refusals.h"
#include "server/sessions/memory_reserve.h"
#include "server/sessions/shown_bytes.h"
#include "server/wire/status_mapping.h"

namespace lipofill::server {
namespace {

/// A stream that is held back looks again after so long.
constexpr std::chrono::milliseconds kHeldBack{100};

}  // namespace

bool WatchStream::begin(std::shared_ptr<Viewer> viewer, Courier::Clock::duration heartbeat,
                        std::function<void()> on_done) {
  std::unique_lock lock(mutex_);
  if (finished_) return false;
  self_ = shared_from_this();
  on_done_ = std::move(on_done);
  viewer_ = std::move(viewer);
  clock_.begin(heartbeat, Courier::Clock::now());
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
  outgoing_.add_encoded({kept, &kept->meshes}, {kept, &kept->frame});
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
  clock_.note_woken(Courier::Clock::now());
  advance(std::move(lock));
}

void WatchStream::OnWriteDone(bool ok) {
  std::unique_lock lock(mutex_);
  writing_ = false;
  clock_.note_sent(Courier::Clock::now());
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

// One write is under way at a time, and Finish comes once: after the last write, also when the
// client has gone.
void WatchStream::advance(std::unique_lock<std::mutex> lock) {
  if (writing_ || finished_) return;
  if (cancelled_) {
    end_ = absl::CancelledError("the viewer has gone");
    outgoing_.clear();
  } else if (!end_ && clock_.is_over(Courier::Clock::now(), std::chrono::system_clock::now())) {
    end_ = token_expired();
    outgoing_.clear();
  } else if (outgoing_.empty() && !end_) {
    try {
      const MayFail may_fail;
      const bool is_held_back = !fetch();
      if (outgoing_.empty() && !end_) send_due_heartbeat();
      if (is_held_back) look_again_at(Courier::Clock::now() + kHeldBack);
    } catch (const std::exception& error) {
      end_ = absl::ResourceExhaustedError(error.what());
    }
  }
  if (!outgoing_.empty()) {
    outgoing_.take_next(at_hand_);
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

/// False, and nothing is fetched, where frames take too much: those who read wait until those who
/// do not are ended (LiveCalls).
bool WatchStream::fetch() {
  if (viewer_ != nullptr && shown_bytes() > viewer_->max_shown_bytes()) return false;
  while (outgoing_.empty() && !end_ && viewer_ != nullptr) {
    const ToSend next = viewer_->take();
    if (const auto* meshes = std::get_if<TopologyToSend>(&next)) {
      outgoing_.add(*meshes, viewer_->selection());
    } else if (const auto* frame = std::get_if<FrameToSend>(&next)) {
      outgoing_.add(*frame, viewer_->selection());
    } else if (const auto* end = std::get_if<EndOfStream>(&next)) {
      end_ = end->status;
    } else {
      return true;
    }
  }
  return true;
}

void WatchStream::look_again_at(Courier::Clock::time_point time) {
  clock_.replace_alarm(time);
  courier_.wake_at(weak_from_this(), time);
}

/// Sends a heartbeat if one is due. Otherwise the courier looks again when it will be, or when the
/// stream must end.
void WatchStream::send_due_heartbeat() {
  if (viewer_ == nullptr) return;
  if (clock_.heartbeat_is_due(Courier::Clock::now())) return outgoing_.add_heartbeat(viewer_->unacknowledged());
  if (const auto alarm = clock_.set_alarm(Courier::Clock::now())) courier_.wake_at(weak_from_this(), *alarm);
}

}  // namespace lipofill::server
