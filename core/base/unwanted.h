#pragma once

#include <functional>

#include "absl/status/status.h"

namespace lipofill {

/// Is asked between the steps of long work, on the thread that does it: true once nobody wants the
/// result any more. If it is empty, the result is wanted.
using Unwanted = std::function<bool()>;

/// Returns CANCELLED once the result is unwanted. Checked by tests/unit/base/base_test.cc.
inline absl::Status check_wanted(const Unwanted& unwanted) {
  return unwanted && unwanted() ? absl::CancelledError("nobody waits for the result any more") : absl::OkStatus();
}

}  // namespace lipofill
