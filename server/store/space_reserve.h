#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>

#include "absl/status/status.h"

namespace lipofill::server {

/// A file that holds room on the medium, which is let go of when deleting needs some: to delete, a
/// store writes first, and on a full disk nobody could make room. Thread-safe.
/// Checked by tests/unit/server/store/space_reserve_test.cc and
/// tests/integration/service/full_disk_test.cc.
class SpaceReserve {
 public:
  /// With 0 bytes nothing is held.
  SpaceReserve(std::filesystem::path file, uint64_t bytes);

  /// Takes the room again where there is some. False when it is not held now.
  bool fill();
  /// Does work that makes room. Where there is none for that, lets go of what is held and does it
  /// again; takes it back afterwards, if there is room by then.
  absl::Status spend(const std::function<absl::Status()>& work);

 private:
  /// With the mutex held. Returns false when nothing was held.
  bool let_go();
  bool hold();

  const std::filesystem::path file_;
  const uint64_t bytes_;
  std::mutex mutex_;
};

}  // namespace lipofill::server
