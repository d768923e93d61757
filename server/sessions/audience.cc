#include "server/sessions/audience.h"

#include <algorithm>
#include <utility>

namespace lipofill::server {
namespace {

constexpr double kScreenRateHz = 60.0;
constexpr double kSharedRateHz = 480.0;

}  // namespace

void Audience::join(std::shared_ptr<Viewer> viewer) {
  viewers_.push_back(std::move(viewer));
  share_rate();
}

void Audience::leave(const std::shared_ptr<Viewer>& viewer) {
  std::erase(viewers_, viewer);
  share_rate();
}

void Audience::share_rate() {
  const auto sharing = std::count_if(viewers_.begin(), viewers_.end(), [](const auto& v) { return v->shares_rate(); });
  const double share_hz = kSharedRateHz / static_cast<double>(std::max<std::ptrdiff_t>(sharing, 1));
  for (const auto& viewer : viewers_) {
    if (viewer->shares_rate()) viewer->set_max_rate(std::min(kScreenRateHz, share_hz));
  }
}

void Audience::show(double time_s, bool at_rest, const MakeFrame& make_frame) {
  const size_t closed = std::erase_if(viewers_, [](const auto& viewer) { return viewer->closed(); });
  if (closed > 0) share_rate();
  std::vector<std::shared_ptr<Viewer>> due;
  std::set<std::string> meshes;
  for (const auto& viewer : viewers_) {
    if (!viewer->wants(time_s, at_rest)) continue;
    due.push_back(viewer);
    meshes.insert(viewer->selection().meshes.begin(), viewer->selection().meshes.end());
  }
  if (due.empty()) return;
  const auto frame = make_frame(meshes);
  for (const auto& viewer : due) viewer->offer(frame);
}

void Audience::offer(const std::shared_ptr<const Frame>& frame) {
  for (const auto& viewer : viewers_) viewer->offer(frame);
}

void Audience::rewind() {
  for (const auto& viewer : viewers_) viewer->rewind();
}

void Audience::close(const absl::Status& status) {
  for (const auto& viewer : viewers_) viewer->close(status);
  viewers_.clear();
}

}  // namespace lipofill::server
