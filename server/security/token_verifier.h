#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/security/claims.h"
#include "server/security/token_keys.h"
#include "server/security/watched_file.h"

namespace lipofill::server {

/// Tells of whom a bearer token speaks (decision 016). The key fixes the algorithm: the header's
/// only chooses among the keys, so that neither "none" nor a public key taken for a shared secret
/// gets anywhere. The file of keys may change while the daemon runs. Thread-safe. Checked by
/// tests/unit/server/security/token_verifier_test.cc.
class TokenVerifier {
 public:
  /// Opens the file of keys. INVALID_ARGUMENT naming the file and what is wrong with it.
  static absl::StatusOr<std::unique_ptr<TokenVerifier>> open(const std::string& keys_file, ClaimRules rules);

  /// Verifies a token. UNAUTHENTICATED, reasons TOKEN_MALFORMED, TOKEN_SIGNATURE, TOKEN_ISSUER,
  /// TOKEN_AUDIENCE, TOKEN_EXPIRED and TOKEN_NOT_YET_VALID. Nothing of a token is in any message.
  absl::StatusOr<Principal> verify(const std::string& token,
                                   Principal::Clock::time_point now = Principal::Clock::now()) const;

 private:
  TokenVerifier(std::unique_ptr<WatchedFile<TokenKeys>> keys, ClaimRules rules)
      : keys_(std::move(keys)), rules_(std::move(rules)) {}

  const std::unique_ptr<WatchedFile<TokenKeys>> keys_;
  const ClaimRules rules_;
};

}  // namespace lipofill::server
