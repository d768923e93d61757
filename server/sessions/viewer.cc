#include "server/sessions/viewer.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/field_violations.h"

namespace lipofill::server {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Sorts the names and drops repeated ones, so that viewers who ask for the same in another order
/// share what is made for them.
void sort_out(std::vector<std::string>& names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
}

std::vector<std::string> default_meshes(const std::vector<std::string>& known, const std::vector<std::string>& fields) {
  std::vector<std::string> meshes;
  const auto is_shown = [&fields](const std::string& mesh) {
    if (fields.empty()) return mesh == "skin" || mesh.rfind("film/", 0) == 0;
    return std::any_of(fields.begin(), fields.end(), [&](const std::string& field) { return mesh_of(field) == mesh; });
  };
  std::copy_if(known.begin(), known.end(), std::back_inserter(meshes), is_shown);
  return meshes;
}

}  // namespace

Viewer::Viewer(ViewerOptions options, std::function<void()> wake)
    : options_(std::move(options)),
      wake_(std::move(wake)),
      selection_(options_.selection),
      max_rate_hz_(options_.max_rate_hz) {
  sort_out(selection_.fields);
}

absl::Status Viewer::choose_meshes(const Topology& topology) {
  std::vector<std::string> known;
  for (const auto& mesh : topology.meshes) known.push_back(mesh.name);
  std::vector<std::string>& meshes = selection_.meshes;
  for (size_t i = 0; i < meshes.size(); ++i) {
    if (!contains(known, meshes[i])) {
      return field_violation(absl::StrCat("meshes[", i, "]"),
                             absl::StrCat("is \"", meshes[i], "\", there are ", absl::StrJoin(known, ", ")));
    }
  }
  if (meshes.empty()) meshes = default_meshes(known, selection_.fields);
  sort_out(meshes);
  return absl::OkStatus();
}

absl::Status Viewer::check_fields(const std::vector<std::string>& known) const {
  for (size_t i = 0; i < options_.selection.fields.size(); ++i) {
    const std::string& field = options_.selection.fields[i];
    const std::string path = absl::StrCat("fields[", i, "]");
    if (!contains(known, field)) {
      return field_violation(path, absl::StrCat("is \"", field, "\", there are ", absl::StrJoin(known, ", ")));
    }
    if (!selection_.has_mesh(mesh_of(field))) {
      return field_violation(path, absl::StrCat("is \"", field, "\", of a mesh that is not among `meshes`"));
    }
  }
  return absl::OkStatus();
}

void Viewer::set_max_rate(double max_rate_hz) {
  const std::lock_guard lock(mutex_);
  max_rate_hz_ = max_rate_hz;
}

void Viewer::show_topology(std::shared_ptr<const Topology> topology) {
  {
    const std::lock_guard lock(mutex_);
    topology_ = std::move(topology);
  }
  wake_();
}

bool Viewer::wants(double time_s, bool at_rest, Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  if (end_ || (!at_rest && now < next_due_)) return false;
  // Times are sums of steps: a frame may come a rounding before its due time.
  return time_s >= next_due_s_ - 1e-9 * options_.interval_s;
}

void Viewer::offer(std::shared_ptr<const Frame> frame) {
  {
    const std::lock_guard lock(mutex_);
    if (end_) return;
    if (options_.interval_s > 0.0 && !frame->preview) {
      next_due_s_ = (std::floor(frame->time_s / options_.interval_s + 1e-9) + 1.0) * options_.interval_s;
    }
    if (was_seen(*frame)) return;
    if (!frame->preview) offered_sequence_ = frame->sequence;
    const bool end = frame->end;
    queue_frame(std::move(frame));
    if (end && !end_) end_ = absl::OkStatus();
  }
  wake_();
}

/// True when the viewer has seen the frame's state before. It has seen a preview if it saw any step
/// after it. The last frame is never skipped: it tells the viewer that it is the last, also when it
/// saw the same state before.
bool Viewer::was_seen(const Frame& frame) const {
  if (frame.end) return false;
  if (!frame.preview && frame.sequence == offered_sequence_) return true;
  if (frame.epoch != options_.seen_epoch) return false;
  return frame.preview ? frame.sequence < options_.seen_sequence : frame.sequence <= options_.seen_sequence;
}

/// A newer frame takes the place of an older one, but not of the preview: there is only one.
void Viewer::skip_waiting_frames() {
  const auto is_skipped = [](const std::shared_ptr<const Frame>& frame) { return !frame->preview; };
  for (const auto& frame : frames_) queued_bytes_ -= is_skipped(frame) ? frame->size_bytes() : 0;
  skipped_ += std::erase_if(frames_, is_skipped);
}

void Viewer::rewind() {
  const std::lock_guard lock(mutex_);
  next_due_s_ = 0.0;
  offered_sequence_.reset();
  unacknowledged_.clear();
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

/// The last frame says that it is over, which every viewer may hear.
bool Viewer::must_wait() const {
  return options_.max_unacknowledged > 0 && unacknowledged_.size() >= options_.max_unacknowledged &&
         !frames_.front()->end;
}

FrameToSend Viewer::take_frame(Clock::time_point now) {
  FrameToSend next{std::move(frames_.front()), std::exchange(skipped_, 0)};
  frames_.pop_front();
  queued_bytes_ -= next.frame->size_bytes();
  sent_epoch_ = next.frame->epoch;
  sent_sequence_ = next.frame->sequence;
  if (options_.max_unacknowledged > 0) unacknowledged_.push_back(sent_sequence_);
  if (max_rate_hz_ > 0.0) next_due_ = find_next_due(now);
  return next;
}

Viewer::Clock::time_point Viewer::find_next_due(Clock::time_point now) const {
  const auto period = std::chrono::ceil<Clock::duration>(std::chrono::duration<double>(1.0 / max_rate_hz_));
  if (!options_.shares_rate) return now + period;
  return now + period - now.time_since_epoch() % period;
}

absl::Status Viewer::acknowledge(uint64_t epoch, uint64_t sequence) {
  {
    const std::lock_guard lock(mutex_);
    if (epoch < sent_epoch_) return absl::OkStatus();  // under way when the simulation went back
    if (epoch > sent_epoch_) {
      return field_violation("epoch", absl::StrCat("is ", epoch, ", that of the frames sent is ", sent_epoch_));
    }
    if (sequence > sent_sequence_) {
      return field_violation("sequence", absl::StrCat("is ", sequence, ", the last frame sent is ", sent_sequence_));
    }
    std::erase_if(unacknowledged_, [sequence](uint64_t sent) { return sent <= sequence; });
  }
  wake_();
  return absl::OkStatus();
}

size_t Viewer::unacknowledged() const {
  const std::lock_guard lock(mutex_);
  return unacknowledged_.size();
}

ToSend Viewer::take(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (end_ && !end_->ok()) topology_ = nullptr;
  if (topology_ != nullptr) return TopologyToSend{std::move(topology_)};
  if (!frames_.empty()) {
    if (must_wait()) return std::monostate();
    return take_frame(now);
  }
  if (end_ && !end_taken_) {
    end_taken_ = true;
    return EndOfStream{*end_};
  }
  return std::monostate();
}

}  // namespace lipofill::server
