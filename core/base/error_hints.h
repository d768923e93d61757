#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"

namespace lipofill {

/// Details of an error for programs, in addition to its code: a word for the reason, and when it
/// makes sense to try again.
struct ErrorHints {
  std::string reason;                   ///< "DRAINING"; upper case with underscores
  std::optional<double> retry_delay_s;  ///< the caller may try again after it, not before
};

/// The status with hints. An OK status stays as it is. Checked by tests/unit/base/base_test.cc.
absl::Status with_hints(absl::Status status, const ErrorHints& hints);

/// The hints a status carries.
std::optional<ErrorHints> hints_of(const absl::Status& status);

}  // namespace lipofill
