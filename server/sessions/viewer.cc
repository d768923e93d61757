#include "server/sessions/viewer.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/field_violations.h"

namespace lipofill::server {

Viewer::Viewer(ViewerOptions options, std::function<void()> wake)
    : options_(std::move(options)), wake_(std::move(wake)) {}

absl::Status Viewer::choose_meshes(const Topology& topology) {
  std::vector<std::string> known;
  for (const auto& mesh : topology.meshes) known.push_back(mesh.name);
  meshes_.clear();
  for (size_t i = 0; i < options_.meshes.size(); ++i) {
    if (!topology.has(options_.meshes[i])) {
      return field_violation(absl::StrCat("meshes[", i, "]"),
                             absl::StrCat("is \"", options_.meshes[i], "\", there are ", absl::StrJoin(known, ", ")));
    }
    meshes_.push_back(options_.meshes[i]);
  }
  if (meshes_.empty()) {
    std::copy_if(known.begin(), known.end(), std::back_inserter(meshes_),
                 [](const std::string& name) { return name == "skin" || name.rfind("film/", 0) == 0; });
  }
  std::sort(meshes_.begin(), meshes_.end());
  meshes_.erase(std::unique(meshes_.begin(), meshes_.end()), meshes_.end());
  return absl::OkStatus();
}

void Viewer::show_topology(std::shared_ptr<const Topology> topology) {
  {
    const std::lock_guard lock(mutex_);
    topology_ = std::move(topology);
  }
  wake_();
}

bool Viewer::wants(double time_s) const {
  const std::lock_guard lock(mutex_);
  // Times are sums of steps: a frame may come a rounding before its due time.
  return !end_ && time_s >= next_due_s_ - 1e-9 * options_.interval_s;
}

void Viewer::offer(std::shared_ptr<const Frame> frame) {
  {
    const std::lock_guard lock(mutex_);
    if (end_) return;
    if (options_.interval_s > 0.0 && !frame->preview) {
      next_due_s_ = (std::floor(frame->time_s / options_.interval_s + 1e-9) + 1.0) * options_.interval_s;
    }
    if (was_seen(*frame)) return;
    const bool end = frame->end;
    queue_frame(std::move(frame));
    if (end && !end_) end_ = absl::OkStatus();
  }
  wake_();
}

/// A preview was seen by who saw a step after it. The last frame says that it is the last one, even to who saw the same
/// state before.
bool Viewer::was_seen(const Frame& frame) const {
  if (frame.epoch != options_.seen_epoch || frame.end) return false;
  return frame.preview ? frame.sequence < options_.seen_sequence : frame.sequence <= options_.seen_sequence;
}

/// A newer frame takes the place of an older one, but not of the preview: there is only one.
void Viewer::skip_waiting_frames() {
  const auto is_skipped = [](const std::shared_ptr<const Frame>& frame) { return !frame->preview; };
  for (const auto& frame : frames_) queued_bytes_ -= is_skipped(frame) ? frame->size_bytes() : 0;
  skipped_ += std::erase_if(frames_, is_skipped);
}

void Viewer::queue_frame(std::shared_ptr<const Frame> frame) {
  const size_t bytes = frame->size_bytes();
  if (options_.delivery == Delivery::kLatest) {
    if (!frame->preview) skip_waiting_frames();
  } else if (!frames_.empty() && queued_bytes_ + bytes > options_.max_queued_bytes) {
    end_ = absl::ResourceExhaustedError(absl::StrCat("this viewer has ", frames_.size(), " frames (", queued_bytes_,
                                                     " bytes) waiting, the bound is ", options_.max_queued_bytes,
                                                     " bytes; read faster, set interval_ms, or watch with LATEST"));
    frames_.clear();
    return;
  }
  frames_.push_back(std::move(frame));
  queued_bytes_ += bytes;
}

void Viewer::close(absl::Status status) {
  {
    const std::lock_guard lock(mutex_);
    if (end_ && !end_->ok()) return;
    if (!status.ok()) frames_.clear();
    end_ = std::move(status);
  }
  wake_();
}

bool Viewer::closed() const {
  const std::lock_guard lock(mutex_);
  return end_.has_value();
}

ToSend Viewer::take() {
  const std::lock_guard lock(mutex_);
  if (end_ && !end_->ok()) topology_ = nullptr;
  if (topology_ != nullptr) return TopologyToSend{std::move(topology_)};
  if (!frames_.empty()) {
    FrameToSend next{std::move(frames_.front()), std::exchange(skipped_, 0)};
    frames_.pop_front();
    queued_bytes_ -= next.frame->size_bytes();
    return next;
  }
  if (end_ && !end_taken_) {
    end_taken_ = true;
    return EndOfStream{*end_};
  }
  return std::monostate();
}

}  // namespace lipofill::server
