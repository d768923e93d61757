#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/security/certificate_map.h"
#include "server/security/revocation_list.h"
#include "server/security/security_settings.h"
#include "server/security/token_verifier.h"

namespace lipofill::server {

/// The parts of a call that say who makes it.
struct Credentials {
  std::vector<std::string> authorization;  ///< values of the metadata "authorization"
  bool has_certificate = false;            ///< that the client's authorities have signed
  std::vector<std::string> common_names;
  std::vector<std::string> alternative_names;
  bool is_unix_socket = false;
};

/// Tells who calls: by a bearer token; without one by the client certificate; without either, where
/// it is so set, by having come through a UNIX socket. Where neither tokens nor certificates are
/// set up, everybody is the user of this machine. Thread-safe. Checked by
/// tests/unit/server/security/authenticator_test.cc and tests/integration/security/.
class Authenticator {
 public:
  /// Opens the files. INVALID_ARGUMENT with a violation for every file that cannot be used.
  static absl::StatusOr<std::unique_ptr<Authenticator>> open(const SecuritySettings& settings);

  /// True when callers must say who they are.
  bool asks() const { return tokens_ != nullptr || certificates_ != nullptr; }

  /// Who is revoked as of now; nullptr where no list is set up.
  std::shared_ptr<const RevocationList> revocations() const { return revoked_ != nullptr ? revoked_->get() : nullptr; }

  /// Finds who calls. UNAUTHENTICATED with a reason: NO_CREDENTIALS, TOKEN_...,
  /// CERTIFICATE_UNKNOWN, CREDENTIALS_REVOKED, CREDENTIALS_DISAGREE for a token of another tenant
  /// than its certificate.
  absl::StatusOr<Principal> identify(const Credentials& credentials) const;

 private:
  Authenticator() = default;
  absl::StatusOr<Principal> identify_any(const Credentials& credentials, const Principal* holder) const;
  absl::StatusOr<Principal> identify_by_token(const Credentials& credentials, const Principal* holder) const;

  bool trusts_unix_sockets_ = false;
  std::unique_ptr<TokenVerifier> tokens_;
  std::unique_ptr<WatchedFile<CertificateMap>> certificates_;
  std::unique_ptr<WatchedFile<RevocationList>> revoked_;
};

}  // namespace lipofill::server
