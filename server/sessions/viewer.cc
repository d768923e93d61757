#include "server/sessions/viewer.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/field_violations.h"

namespace lipofill::server {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
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
      frames_(options_.delivery, options_.max_queued_bytes, options_.max_shown_bytes),
      pace_(options_.interval_s, options_.max_rate_hz, options_.shares_rate),
      acknowledgements_(options_.max_unacknowledged) {
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
  pace_.set_max_rate(max_rate_hz);
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
  return !end_ && pace_.is_due(time_s, at_rest, now);
}

void Viewer::offer(std::shared_ptr<const Frame> frame) {
  {
    const std::lock_guard lock(mutex_);
    if (end_) return;
    if (!frame->preview) pace_.note_offered(frame->time_s);
    if (was_seen(*frame)) return;
    if (!frame->preview) offered_sequence_ = frame->sequence;
    const bool end = frame->end;
    const absl::Status queued = frames_.push(std::move(frame));
    if (end || !queued.ok()) end_ = queued;
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

void Viewer::rewind() {
  const std::lock_guard lock(mutex_);
  pace_.rewind();
  offered_sequence_.reset();
  acknowledgements_.rewind();
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
  return acknowledgements_.must_wait() && !frames_.front().end;
}

FrameToSend Viewer::take_frame(Clock::time_point now) {
  FrameToSend next = frames_.pop();
  acknowledgements_.note_sent(next.frame->epoch, next.frame->sequence);
  pace_.note_taken(now);
  return next;
}

absl::Status Viewer::acknowledge(uint64_t epoch, uint64_t sequence) {
  {
    const std::lock_guard lock(mutex_);
    if (absl::Status known = acknowledgements_.acknowledge(epoch, sequence); !known.ok()) return known;
  }
  wake_();
  return absl::OkStatus();
}

size_t Viewer::unacknowledged() const {
  const std::lock_guard lock(mutex_);
  return acknowledgements_.on_their_way();
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
