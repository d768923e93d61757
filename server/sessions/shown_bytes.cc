#include "server/sessions/shown_bytes.h"

#include <atomic>

#include "absl/strings/str_cat.h"
#include "server/sessions/shortage.h"

namespace lipofill::server {
namespace {

constexpr double kRetryDelayS = 2.0;

std::atomic<uint64_t>& total() {
  static std::atomic<uint64_t> bytes = 0;
  return bytes;
}

}  // namespace

uint64_t shown_bytes() {
  return total();
}

absl::Status too_many_shown(uint64_t most) {
  return shortage("TOO_MANY_FRAMES", kRetryDelayS,
                  absl::StrCat("frames that viewers have yet to read would take ", shown_bytes(), " bytes, may take ",
                               most, "; read faster, or ask for fewer fields"));
}

ShownBytes::ShownBytes(uint64_t bytes) : bytes_(bytes) {
  total() += bytes_;
}

ShownBytes::~ShownBytes() {
  total() -= bytes_;
}

}  // namespace lipofill::server
