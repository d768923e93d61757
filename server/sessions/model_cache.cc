#include "server/sessions/model_cache.h"

#include <algorithm>

namespace lipofill::server {

absl::StatusOr<ModelCache::Model> ModelCache::get(const std::string& name, const Build& build) {
  if (Model known = find(name); known != nullptr) return known;
  auto built = build();
  if (built.ok()) put(name, *built);
  return built;
}

ModelCache::Model ModelCache::find(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&name](const auto& entry) { return entry.first == name; });
  if (found == entries_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, found);
  return entries_.front().second;
}

void ModelCache::put(const std::string& name, Model model) {
  const std::lock_guard lock(mutex_);
  entries_.remove_if([&name](const auto& entry) { return entry.first == name; });
  entries_.emplace_front(name, std::move(model));
  while (entries_.size() > capacity_) entries_.pop_back();
}

void ModelCache::remove(const std::string& name) {
  const std::lock_guard lock(mutex_);
  entries_.remove_if([&name](const auto& entry) { return entry.first == name; });
}

size_t ModelCache::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

}  // namespace lipofill::server
