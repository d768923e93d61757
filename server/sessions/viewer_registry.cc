#include "server/sessions/viewer_registry.h"

namespace lipofill::server {

void ViewerRegistry::add(const std::string& simulation, const std::string& name, std::shared_ptr<Viewer> viewer) {
  std::shared_ptr<Viewer> former;
  {
    const std::lock_guard lock(mutex_);
    former = std::exchange(viewers_[{simulation, name}], std::move(viewer));
  }
  if (former != nullptr) former->close(absl::AbortedError("another Watch of this viewer took its place"));
}

void ViewerRegistry::remove(const std::string& simulation, const std::string& name,
                            const std::shared_ptr<Viewer>& viewer) {
  const std::lock_guard lock(mutex_);
  const auto found = viewers_.find({simulation, name});
  if (found != viewers_.end() && found->second == viewer) viewers_.erase(found);
}

std::shared_ptr<Viewer> ViewerRegistry::find(const std::string& simulation, const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = viewers_.find({simulation, name});
  return found == viewers_.end() ? nullptr : found->second;
}

}  // namespace lipofill::server
