#include "server/sessions/frame_queue.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace lipofill::server {

absl::Status FrameQueue::push(std::shared_ptr<const Frame> frame) {
  const size_t bytes = frame->size_bytes();
  if (delivery_ == Delivery::kLatest) {
    if (!frame->preview) skip_waiting();
  } else if (!frames_.empty() && bytes_ + bytes > max_bytes_) {
    absl::Status overflow = absl::ResourceExhaustedError(
        absl::StrCat("this viewer has ", frames_.size(), " frames (", bytes_, " bytes) waiting, the bound is ",
                     max_bytes_, " bytes; read faster, set interval_ms, or watch with LATEST"));
    clear();
    return overflow;
  } else if (!frames_.empty() && shown_bytes() + bytes > max_shown_) {
    absl::Status overflow = too_many_shown(max_shown_);
    clear();
    return overflow;
  }
  frames_.push_back(std::move(frame));
  bytes_ += bytes;
  count();
  return absl::OkStatus();
}

/// A newer frame takes the place of an older one, but not of the preview: there is only one.
void FrameQueue::skip_waiting() {
  const auto is_skipped = [](const std::shared_ptr<const Frame>& frame) { return !frame->preview; };
  for (const auto& frame : frames_) bytes_ -= is_skipped(frame) ? frame->size_bytes() : 0;
  skipped_ += std::erase_if(frames_, is_skipped);
}

FrameToSend FrameQueue::pop() {
  FrameToSend next{std::move(frames_.front()), std::exchange(skipped_, 0)};
  frames_.pop_front();
  bytes_ -= next.frame->size_bytes();
  count();
  return next;
}

void FrameQueue::clear() {
  frames_.clear();
  bytes_ = 0;
  count();
}

}  // namespace lipofill::server
