// The viewers of a session: the meshes it shows, and frames for everyone who watches.

#include <algorithm>
#include <exception>
#include <set>

#include "absl/strings/str_cat.h"
#include "server/sessions/draining.h"
#include "server/sessions/session.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {

void Session::watch(std::shared_ptr<Viewer> viewer) {
  ++watching_;
  post([this, viewer] {
    if (parked_) return viewer->close(just_parked());
    try {
      const auto meshes = topology();
      if (const absl::Status chosen = viewer->choose_meshes(*meshes); !chosen.ok()) return viewer->close(chosen);
      const auto frame = last_frame_ != nullptr ? last_frame_ : make_frame(viewer->selection().meshes, false);
      if (const absl::Status known = viewer->check_fields(frame->field_names()); !known.ok())
        return viewer->close(known);
      viewer->show_topology(meshes);
      if (preview_frame_ != nullptr) viewer->offer(preview_frame_);
      viewer->offer(frame);
      if (frame->end) return;
      viewers_.push_back(viewer);
      share_rate();
    } catch (const std::exception& error) {
      viewer->close(absl::InternalError(absl::StrCat("simulations/", options_.id, ": ", error.what())));
    }
  });
}

void Session::unwatch(std::shared_ptr<Viewer> viewer) {
  --watching_;
  last_asked_ = Clock::now();
  post([this, viewer] {
    std::erase(viewers_, viewer);
    share_rate();
  });
}

void Session::capture(std::vector<std::string> meshes, CaptureReply reply) {
  post([this, meshes, reply] {
    std::shared_ptr<const Topology> shown;
    std::shared_ptr<const Frame> frame;
    if (parked_) return reply(shown, frame);
    try {
      shown = topology();
      frame = last_frame_ != nullptr ? last_frame_ : make_frame(meshes, false);
    } catch (const std::exception& error) {
      spdlog::error("simulations/{}: its fields cannot be taken: {}", options_.id, error.what());
    }
    reply(shown, frame);
  });
}

void Session::close_viewers(absl::Status status) {
  post([this, status] {
    for (const auto& viewer : viewers_) viewer->close(status);
    viewers_.clear();
  });
}

std::shared_ptr<const Topology> Session::topology() {
  if (topology_ == nullptr) {
    auto made = std::make_shared<Topology>();
    made->meshes = simulation_->topology();
    topology_ = made;
  }
  return topology_;
}

std::shared_ptr<const Frame> Session::make_frame(const std::vector<std::string>& meshes, bool end) {
  auto frame = std::make_shared<Frame>();
  frame->epoch = epoch_;
  frame->sequence = simulation_->report().step;
  frame->time_s = simulation_->report().time;
  frame->end = end;
  frame->fields = simulation_->frame(meshes);
  return frame;
}

/// Sets the rate of viewers who ask for none: that of screens, and less when they are many, so that
/// sending to all of them takes a twentieth of the time of short steps.
void Session::share_rate() {
  constexpr double kScreenRate = 60.0;
  constexpr double kSharedRate = 480.0;
  const auto sharing = std::count_if(viewers_.begin(), viewers_.end(), [](const auto& v) { return v->shares_rate(); });
  const double rate_hz = std::min(kScreenRate, kSharedRate / static_cast<double>(std::max<std::ptrdiff_t>(sharing, 1)));
  for (const auto& viewer : viewers_) {
    if (viewer->shares_rate()) viewer->set_max_rate(rate_hz);
  }
}

/// @param at_rest  no step follows soon
void Session::show_to_viewers(bool at_rest) {
  const size_t closed = std::erase_if(viewers_, [](const auto& viewer) { return viewer->closed(); });
  if (closed > 0) share_rate();
  std::vector<std::shared_ptr<Viewer>> due;
  std::set<std::string> meshes;
  for (const auto& viewer : viewers_) {
    if (!viewer->wants(simulation_->report().time, at_rest)) continue;
    due.push_back(viewer);
    meshes.insert(viewer->selection().meshes.begin(), viewer->selection().meshes.end());
  }
  if (due.empty()) return;
  const auto frame = make_frame({meshes.begin(), meshes.end()}, false);
  for (const auto& viewer : due) viewer->offer(frame);
}

// The simulation is at another place of its time, in a new epoch.
void Session::show_again_from_here() {
  for (const auto& viewer : viewers_) viewer->rewind();
  show_to_viewers(true);
}

}  // namespace lipofill::server
