#include "server/security/authenticator.h"

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "core/base/field_violations.h"
#include "server/security/refusals.h"

namespace lipofill::server {
namespace {

constexpr absl::string_view kBearer = "Bearer ";

void note(const char* setting, const absl::Status& status, FieldViolations& violations) {
  if (!status.ok()) violations.add(setting, std::string(status.message()));
}

}  // namespace

absl::StatusOr<std::unique_ptr<Authenticator>> Authenticator::open(const SecuritySettings& settings) {
  std::unique_ptr<Authenticator> self(new Authenticator);
  self->trusts_unix_sockets_ = settings.trust_unix_sockets;
  FieldViolations violations;
  if (settings.has_tokens()) {
    const ClaimRules rules{settings.token_issuer, settings.token_audience,
                           std::chrono::seconds(settings.token_clock_skew_s)};
    auto tokens = TokenVerifier::open(settings.token_keys_file, rules);
    note("token-keys-file", tokens.status(), violations);
    if (tokens.ok()) self->tokens_ = *std::move(tokens);
  }
  if (settings.has_certificates()) {
    auto certificates = WatchedFile<CertificateMap>::open(settings.client_certificates_file, CertificateMap::parse);
    note("client-certificates-file", certificates.status(), violations);
    if (certificates.ok()) self->certificates_ = *std::move(certificates);
  }
  if (!settings.revoked_file.empty()) {
    auto revoked = WatchedFile<RevocationList>::open(settings.revoked_file, RevocationList::parse);
    note("revoked-file", revoked.status(), violations);
    if (revoked.ok()) self->revoked_ = *std::move(revoked);
  }
  if (!violations.empty()) return violations.to_status();
  return self;
}

absl::StatusOr<Principal> Authenticator::identify(const Credentials& credentials) const {
  if (!asks()) return Principal{};
  const auto map = certificates_ != nullptr ? certificates_->get() : nullptr;
  const Principal* holder = map != nullptr && credentials.has_certificate
                                ? map->find(credentials.common_names, credentials.alternative_names)
                                : nullptr;
  auto principal = identify_any(credentials, holder);
  const auto revoked = revocations();
  if (revoked == nullptr || !principal.ok()) return principal;
  // A machine whose certificate was revoked speaks for nobody either.
  if (revoked->has(*principal) || (holder != nullptr && revoked->has(*holder))) return credentials_revoked();
  return principal;
}

absl::StatusOr<Principal> Authenticator::identify_any(const Credentials& credentials, const Principal* holder) const {
  if (tokens_ != nullptr && !credentials.authorization.empty()) return identify_by_token(credentials, holder);
  if (holder != nullptr) return *holder;
  if (credentials.is_unix_socket && trusts_unix_sockets_) return Principal{};
  if (certificates_ != nullptr && credentials.has_certificate) {
    return unauthenticated("CERTIFICATE_UNKNOWN", "nobody is known by this client certificate's names");
  }
  return unauthenticated("NO_CREDENTIALS", "the daemon asks who calls: send a bearer token, or a client certificate");
}

absl::StatusOr<Principal> Authenticator::identify_by_token(const Credentials& credentials,
                                                           const Principal* holder) const {
  const std::string& text = credentials.authorization.front();
  if (credentials.authorization.size() != 1 || !absl::StartsWithIgnoreCase(text, kBearer)) {
    return unauthenticated("TOKEN_MALFORMED", "the metadata \"authorization\" must be there once: Bearer TOKEN");
  }
  auto principal = tokens_->verify(std::string(absl::StripAsciiWhitespace(text.substr(kBearer.size()))));
  if (principal.ok() && holder != nullptr && holder->scope.tenant != principal->scope.tenant) {
    return unauthenticated("CREDENTIALS_DISAGREE", "the token and the client certificate are of different tenants");
  }
  return principal;
}

}  // namespace lipofill::server
