#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/strings/cord.h"
#include "core/base/field_violations.h"

namespace lipofill::server {

/// The same status with its field violations below `prefix`, the field of the request that holds
/// the message they are about.
inline absl::Status with_prefix(const std::string& prefix, const absl::Status& status) {
  if (status.ok() || field_violations_of(status).empty()) return status;
  FieldViolations violations;
  violations.absorb(prefix, status);
  const absl::Status prefixed = violations.to_status();
  absl::Status result(status.code(), prefixed.message());
  prefixed.ForEachPayload([&result](auto url, const absl::Cord& payload) { result.SetPayload(url, payload); });
  return result;
}

}  // namespace lipofill::server
