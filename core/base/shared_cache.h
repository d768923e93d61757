#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "absl/status/statusor.h"

namespace lipofill {

/// Immutable values that equal requests share as long as anyone holds them; it holds none itself.
/// Thread-safe. Two who ask for the same at once may both make it, and then share what the first
/// one made. Checked by tests/unit/base/shared_cache_test.cc.
template <typename Value>
class SharedCache {
 public:
  using Pointer = std::shared_ptr<const Value>;

  /// The value under `key`; where there is none, what `make` returns: an absl::StatusOr<Pointer>.
  /// Equal keys must mean equal values.
  template <typename Make>
  absl::StatusOr<Pointer> get(const std::string& key, const Make& make) {
    if (Pointer held = find(key)) return held;
    absl::StatusOr<Pointer> made = make();
    if (!made.ok()) return made;
    const std::lock_guard lock(mutex_);
    std::weak_ptr<const Value>& entry = values_[key];
    if (Pointer first = entry.lock()) return first;
    entry = *made;
    return made;
  }

  /// Number of keys whose value someone holds.
  size_t size() const {
    const std::lock_guard lock(mutex_);
    size_t held = 0;
    for (const auto& [key, value] : values_) held += value.expired() ? 0 : 1;
    return held;
  }

 private:
  Pointer find(const std::string& key) {
    const std::lock_guard lock(mutex_);
    std::erase_if(values_, [](const auto& entry) { return entry.second.expired(); });
    const auto found = values_.find(key);
    return found == values_.end() ? nullptr : found->second.lock();
  }

  mutable std::mutex mutex_;
  std::map<std::string, std::weak_ptr<const Value>> values_;
};

}  // namespace lipofill
