#pragma once

#include <functional>

#include "absl/status/status.h"

namespace lipofill {

/// Asked between the steps of long work, on the thread that does it: true once nobody wants the result any more. Empty:
/// it is wanted.
using Unwanted = std::function<bool()>;

/// CANCELLED once it is unwanted. Checked by tests/unit/base/base_test.cc.
inline absl::Status check_wanted(const Unwanted& unwanted) {
  return unwanted && unwanted() ? absl::CancelledError("nobody waits for the result any more") : absl::OkStatus();
}

}  // namespace lipofill
