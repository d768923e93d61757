#include "server/security/token_verifier.h"

#include <algorithm>

#include "server/security/refusals.h"
#include "server/security/token_signature.h"

namespace lipofill::server {
namespace {

bool may_have_signed(const TokenKey& key, const TokenParts& parts) {
  return key.algorithm == parts.algorithm && (key.id.empty() || parts.key_id.empty() || key.id == parts.key_id);
}

}  // namespace

absl::StatusOr<std::unique_ptr<TokenVerifier>> TokenVerifier::open(const std::string& keys_file, ClaimRules rules) {
  auto keys = WatchedFile<TokenKeys>::open(keys_file, parse_token_keys);
  if (!keys.ok()) return keys.status();
  return std::unique_ptr<TokenVerifier>(new TokenVerifier(*std::move(keys), std::move(rules)));
}

absl::StatusOr<Principal> TokenVerifier::verify(const std::string& token, Principal::Clock::time_point now) const {
  const auto parts = take_token_apart(token);
  if (!parts.ok()) return parts.status();
  const auto keys = keys_->get();
  const bool is_signed = std::any_of(keys->begin(), keys->end(), [&](const TokenKey& key) {
    return may_have_signed(key, *parts) && is_signed_by(token, key);
  });
  if (!is_signed) return unauthenticated("TOKEN_SIGNATURE", "the token is signed by no key that this daemon trusts");
  return read_claims(parts->claims, rules_, now);
}

}  // namespace lipofill::server
