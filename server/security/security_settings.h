#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"

namespace lipofill::server {

/// The settings by which the daemon is guarded. An empty file name turns its feature off. Secrets
/// are in files, never in settings.
struct SecuritySettings {
  std::string tls_certificate_file;  ///< PEM: the certificate, then those between it and its authority
  std::string tls_key_file;
  std::string tls_client_ca_file;  ///< PEM: who signs client certificates
  bool tls_client_certificate_optional = false;
  std::string client_certificates_file;
  std::string token_keys_file;
  std::string token_issuer;
  std::string token_audience;
  std::string revoked_file;
  int token_clock_skew_s = 30;
  bool trust_unix_sockets = false;
  std::string audit_file;  ///< where it is empty, audit_file_in() says
  std::string audit_key_file;
  uint64_t audit_rotate_mb = 64;

  bool has_tls() const { return !tls_certificate_file.empty(); }
  bool has_tokens() const { return !token_keys_file.empty(); }
  bool has_certificates() const { return !client_certificates_file.empty(); }
  /// True when callers must say who they are.
  bool has_authentication() const { return has_tokens() || has_certificates(); }
  /// Path of the audit log; empty for none. There always is one when callers must say who they are.
  std::string audit_file_in(const std::string& data_directory) const;
};

/// Checks the settings and returns field violations by their names: files that cannot be used, a
/// key that is not its certificate's, a setting without another that it needs. Checked by
/// tests/integration/security/settings_test.cc.
absl::Status check_security(const SecuritySettings& settings);

}  // namespace lipofill::server
