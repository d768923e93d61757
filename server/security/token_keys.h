#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::server {

/// A public key that tokens may be signed with, and the one algorithm it is for.
struct TokenKey {
  std::string id;         ///< "kid" of the JWKS; empty in a PEM file
  std::string algorithm;  ///< "RS256", "ES256" or "EdDSA"
  std::string pem;
};
using TokenKeys = std::vector<TokenKey>;

/// The keys in a file: one or more PEM blocks "PUBLIC KEY", or a JSON Web Key Set (RFC 7517). RSA
/// keys have at least 2048 bits, elliptic ones lie on P-256 or are Ed25519 (RFC 8037).
/// INVALID_ARGUMENT saying which key is of no use, and for private keys and shared secrets: whoever
/// verifies tokens must not be able to make them. Checked by
/// tests/unit/server/security/token_keys_test.cc.
absl::StatusOr<TokenKeys> parse_token_keys(const std::string& text);

}  // namespace lipofill::server
