#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "server/sessions/viewer.h"

namespace lipofill::server {

/// Viewers under way that acknowledge frames, by simulation and name. Thread-safe.
/// Checked by tests/unit/server/sessions/viewer_registry_test.cc.
class ViewerRegistry {
 public:
  /// A viewer of the same name, which its client has left for this one, is closed with ABORTED.
  void add(const std::string& simulation, const std::string& name, std::shared_ptr<Viewer> viewer);
  /// Removes the viewer, unless another has taken its place.
  void remove(const std::string& simulation, const std::string& name, const std::shared_ptr<Viewer>& viewer);
  /// Finds a viewer; nullptr when there is none.
  std::shared_ptr<Viewer> find(const std::string& simulation, const std::string& name) const;

 private:
  using Key = std::pair<std::string, std::string>;

  mutable std::mutex mutex_;
  std::map<Key, std::shared_ptr<Viewer>> viewers_;
};

}  // namespace lipofill::server
