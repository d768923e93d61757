#pragma once

#include "absl/status/status.h"
#include "core/base/error_hints.h"

namespace lipofill::server {

/// Refuses new work once the daemon drains, and ends viewers' streams then: UNAVAILABLE with the
/// reason DRAINING. The client may try again in a while, here or at another daemon.
inline absl::Status draining() {
  constexpr double retry_delay_s = 5.0;
  return with_hints(absl::UnavailableError("the daemon is draining: it stops soon and takes nothing new"),
                    {"DRAINING", retry_delay_s});
}

/// Answers a caller who held on to a session while it was parked; the next call wakes it.
inline absl::Status just_parked() {
  constexpr double retry_delay_s = 0.1;
  return with_hints(absl::UnavailableError("the simulation was parked at this moment; try again"),
                    {"PARKED", retry_delay_s});
}

}  // namespace lipofill::server
