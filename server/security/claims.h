#pragma once

#include "absl/status/statusor.h"
#include "nlohmann/json.hpp"
#include "server/security/principal.h"

namespace lipofill::server {

/// Claims that every token must make to be accepted, besides being signed.
struct ClaimRules {
  std::string issuer;
  std::string audience;
  std::chrono::seconds clock_skew{30};  ///< how far the clocks of issuer and daemon may be apart
};

/// Returns the person of whom a token speaks. Claims: iss and aud as the rules have them (aud a
/// text or a list), exp, nbf, iat and jti where present, sub (1 to 256 bytes), tenant, roles (a
/// list; the highest counts), and where it is limited to some patients `patients`, a list of ids.
/// UNAUTHENTICATED with a reason for each way to be wrong. Checked by
/// tests/unit/server/security/claims_test.cc.
absl::StatusOr<Principal> read_claims(const nlohmann::json& claims, const ClaimRules& rules,
                                      Principal::Clock::time_point now);

/// The roles and patients of a JSON object, as claims and entries of the certificate file have
/// them. INVALID_ARGUMENT saying which member is wrong.
absl::Status read_rights(const nlohmann::json& object, Principal& principal);

}  // namespace lipofill::server
