#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/simulation/simulation.h"
#include "server/sessions/shown_bytes.h"

namespace lipofill::server {

/// Messages ready for the wire, and the hash of the meshes they belong to.
struct EncodedMessages {
  std::string topology_hash;
  std::vector<std::string> messages;
  ShownBytes counted = {};
};

/// Encodings of one thing, one for each set of meshes, made by whoever needs it first and shared by
/// all viewers. Of more than kMostKept those that nobody sends are made again when they are wanted:
/// there are as many as subsets of fields.
class EncodingCache {
 public:
  using Encoder = std::function<EncodedMessages()>;
  static constexpr size_t kMostKept = 4;

  /// The encoding under `key`; others that ask for it meanwhile wait.
  std::shared_ptr<const EncodedMessages> get(const std::string& key, const Encoder& encode) const {
    const std::lock_guard lock(mutex_);
    if (const auto found = entries_.find(key); found != entries_.end()) return found->second;
    if (entries_.size() >= kMostKept) {
      std::erase_if(entries_, [](const auto& entry) { return entry.second.use_count() == 1; });
    }
    return entries_[key] = std::make_shared<const EncodedMessages>(encode());
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::shared_ptr<const EncodedMessages>> entries_;
};

/// The meshes of a simulation, at rest.
struct Topology {
  std::vector<simulation::MeshTopology> meshes;
  EncodingCache encodings;

  bool has(const std::string& mesh) const {
    for (const auto& m : meshes) {
      if (m.name == mesh) return true;
    }
    return false;
  }
};

/// The state after a step, as viewers see it. Immutable once shared.
struct Frame {
  uint64_t epoch = 0;
  uint64_t sequence = 0;
  double time_s = 0.0;
  bool end = false;      ///< nothing comes after it
  bool preview = false;  ///< the settled shape as a coarse model foresees it
  std::vector<simulation::FrameField> fields;
  EncodingCache encodings;

  /// Names "<mesh>.<field>" of all fields.
  std::vector<std::string> field_names() const {
    std::vector<std::string> names;
    for (const auto& field : fields) names.push_back(field.mesh + "." + field.name);
    return names;
  }

  size_t size_bytes() const {
    size_t bytes = 0;
    for (const auto& field : fields) bytes += field.values.size() * sizeof(float);
    return bytes;
  }
};

}  // namespace lipofill::server
