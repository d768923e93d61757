#pragma once

#include <string>

#include "absl/status/status.h"
#include "core/base/error_hints.h"

namespace lipofill::server {

/// Refuses a caller whom nobody knows: UNAUTHENTICATED with a reason of its own, "TOKEN_EXPIRED".
inline absl::Status unauthenticated(const std::string& reason, const std::string& message) {
  return with_hints(absl::UnauthenticatedError(message), {reason, {}});
}

/// Refuses a known caller who may not do this: PERMISSION_DENIED.
inline absl::Status permission_denied(const std::string& reason, const std::string& message) {
  return with_hints(absl::PermissionDeniedError(message), {reason, {}});
}

/// Ends a call that goes on longer than the token with which it began.
inline absl::Status token_expired() {
  return unauthenticated("TOKEN_EXPIRED", "the token has expired; call again with a new one");
}

/// Refuses, or ends, a call of somebody whose credentials were revoked.
inline absl::Status credentials_revoked() {
  return unauthenticated("CREDENTIALS_REVOKED", "the credentials were revoked; ask their issuer for new ones");
}

}  // namespace lipofill::server
