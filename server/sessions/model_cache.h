#pragma once

#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "core/model/face_model.h"

namespace lipofill::server {

/// Built models, the most recently used few, by resource name. Simulations hold on to theirs
/// longer.
/// Checked by tests/unit/server/sessions/model_cache_test.cc.
class ModelCache {
 public:
  using Model = std::shared_ptr<const model::FaceModel>;
  using Build = std::function<absl::StatusOr<Model>()>;

  explicit ModelCache(size_t capacity) : capacity_(capacity) {}

  /// Builds it when it is not there. Two callers at once may both build: the results are equal.
  absl::StatusOr<Model> get(const std::string& name, const Build& build);
  void put(const std::string& name, Model model);
  void remove(const std::string& name);
  size_t size() const;

 private:
  Model find(const std::string& name);

  const size_t capacity_;
  mutable std::mutex mutex_;
  std::list<std::pair<std::string, Model>> entries_;  ///< most recent first
};

}  // namespace lipofill::server
