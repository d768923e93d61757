#pragma once

#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/base/error_hints.h"

namespace lipofill::server {

/// Answers a caller who wants more than there is now: RESOURCE_EXHAUSTED with the reason
/// "TOO_MANY_..." or "NO_...", and when to try again.
inline absl::Status shortage(std::string reason, double retry_delay_s, absl::string_view message) {
  return with_hints(absl::ResourceExhaustedError(message), {std::move(reason), retry_delay_s});
}

}  // namespace lipofill::server
