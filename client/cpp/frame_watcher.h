#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/cpp/arrays.h"
#include "client/cpp/connection.h"
#include "lipofill/v1/frame_service.pb.h"

namespace lipofill::client {

/// The meshes of a simulation or model at rest.
struct Meshes {
  std::string topology_hash;
  std::vector<Array> arrays;
};

/// The fields of one step.
struct Frame {
  uint64_t epoch = 0;
  uint64_t sequence = 0;
  double time_s = 0.0;
  uint64_t skipped_frames = 0;
  bool end = false;
  std::vector<Array> fields;
  bool preview = false;  ///< the settled shape as a coarse model foresees it, not a step
};

/// Functions that handle the messages of a watch. An error ends the watch with that error.
struct WatchHandlers {
  std::function<absl::Status(Meshes)> on_meshes;
  std::function<absl::Status(Frame)> on_frame;
  /// The stream broke and is taken up again where it was; may be empty.
  std::function<void(const absl::Status&)> on_resume;
};

/// Watches a simulation to its end. A stream that breaks (the daemon restarts, or ends a viewer
/// that fell behind) is taken up again after the last frame seen, up to `kMaxResumes` times in a
/// row without a frame between. The meshes come once, and again only when they changed. A daemon
/// that is silent for kSilentHeartbeats of the heartbeats asked for counts as a broken stream. With
/// max_unacknowledged_frames each frame is acknowledged once on_frame has returned, by a viewer
/// name of the library's own where the request has none. CANCELLED when the connection's stop was
/// asked for. Checked by tests/unit/client/frame_watcher_test.cc and tests/integration/cli/.
absl::Status watch(const Connection& connection, v1::WatchRequest request, const WatchHandlers& handlers);

inline constexpr int kMaxResumes = 8;
inline constexpr int kSilentHeartbeats = 4;
inline constexpr std::chrono::milliseconds kDefaultHeartbeat{10'000};

/// The meshes of a model at rest.
absl::StatusOr<Meshes> download_model_mesh(const Connection& connection, const std::string& model);

}  // namespace lipofill::client
