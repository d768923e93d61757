#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "nlohmann/json.hpp"
#include "server/security/token_keys.h"

namespace lipofill::server {

/// A signed token (JWS, compact: three parts of base64url), taken apart and not yet believed.
struct TokenParts {
  nlohmann::json header;
  nlohmann::json claims;
  std::string key_id;     ///< the header names it; empty without one
  std::string algorithm;  ///< the header names it
};

/// Takes a token apart. UNAUTHENTICATED "TOKEN_MALFORMED" unless it has at most 8 KiB, three parts
/// of base64url, a header and claims that are JSON objects, an algorithm, and no extension that
/// must be understood ("crit").
absl::StatusOr<TokenParts> take_token_apart(const std::string& token);

/// True when the token was signed by the owner of the key, with the key's own algorithm, whatever
/// the token says of algorithms. It takes only tokens that could be taken apart. cpp-jwt is called
/// here and nowhere else; EdDSA, which it has not, is OpenSSL's.
bool is_signed_by(const std::string& token, const TokenKey& key);

}  // namespace lipofill::server
