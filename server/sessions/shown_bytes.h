#pragma once

#include <cstdint>
#include <utility>

#include "absl/status/status.h"

namespace lipofill::server {

/// Tells what frames take in memory now that viewers have yet to read: those that wait in a
/// viewer's queue, and their encodings for the wire, which viewers share.
uint64_t shown_bytes();

/// Ends or refuses a stream of frames where those take more than they may: RESOURCE_EXHAUSTED.
absl::Status too_many_shown(uint64_t most);

/// Counts bytes among shown_bytes() for as long as it is there.
/// Checked by tests/unit/server/sessions/shown_bytes_test.cc.
class ShownBytes {
 public:
  ShownBytes() = default;
  explicit ShownBytes(uint64_t bytes);
  ShownBytes(ShownBytes&& other) noexcept : bytes_(std::exchange(other.bytes_, 0)) {}
  ShownBytes& operator=(ShownBytes&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~ShownBytes();

 private:
  uint64_t bytes_ = 0;
};

}  // namespace lipofill::server
